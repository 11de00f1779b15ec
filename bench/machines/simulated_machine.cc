// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/simulated_machine.h"

#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <fmt/core.h>

#include "analysis/quantities.h"
#include "analysis/units.h"

namespace strainwave::bench {
namespace {

namespace quantities = analysis::quantities;

}  // namespace

SimulatedMachine::SimulatedMachine(const analysis::model::PlantModel& model,
                                   const SimulatedBenchSettings& settings, const SimulatedTest& test)
    : bench_(model, settings), test_(test) {}

BenchDevices SimulatedMachine::Devices() {
  return {bench_.driving_servo(), bench_.load_servo(), bench_.sampler(), bench_.clock()};
}

std::span<const std::byte> SimulatedMachine::Memory() {
  memory_ = bench_.Memory();
  return std::as_bytes(std::span(&memory_, 1));
}

void SimulatedMachine::RestoreMemory(std::span<const std::byte> memory) {
  if (memory.size() != sizeof memory_) {
    throw std::invalid_argument(
        fmt::format("memory of the simulated bench has {} bytes (must be {}: the campaign was "
                    "begun by another version)",
                    memory.size(), sizeof memory_));
  }
  std::memcpy(&memory_, memory.data(), sizeof memory_);
  bench_.RestoreAfterPowerCut(memory_);
}

void SimulatedMachine::CycleMeasured(int cycle) {
  if (test_.truth.empty()) return;
  const bool fresh = !std::filesystem::exists(test_.truth);
  std::ofstream file(test_.truth, std::ios::app);
  if (fresh) {
    file << fmt::format(
        "cycle,{},{},{},{},{},{},{},series_compliance_rad_per_Nm,{},input_revolutions,time_s\n",
        quantities::kK1.name, quantities::kK2.name, quantities::kK3.name, quantities::kEAvg.name,
        quantities::kEMax.name, quantities::kHysteresis.name, quantities::kFrictionTorque.name,
        quantities::kGearTemperature.name);
  }
  const BenchTruth truth = bench_.TruthNow(test_.sweep_step_rad, test_.sweep_steps);
  file << fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", cycle, truth.k1_Nm_per_rad,
                      truth.k2_Nm_per_rad, truth.k3_Nm_per_rad, ArcminFromRad(truth.e_avg_rad),
                      ArcminFromRad(truth.e_max_rad), ArcminFromRad(truth.hysteresis_rad),
                      truth.friction_torque_Nm, truth.series_compliance_rad_per_Nm,
                      truth.gear_temperature_degC, truth.input_revolutions, truth.time_s);
  file.flush();
  if (!file) throw std::system_error(errno, std::generic_category(), test_.truth.string());
}

}  // namespace strainwave::bench
