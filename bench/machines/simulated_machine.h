// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/devices/simulated/simulated_bench.h"
#include "bench/machines/make_machine.h"
#include "bench/roles/bench_machine.h"

namespace strainwave::bench {

/// The simulated bench in the role that a campaign drives.
class SimulatedMachine final : public BenchMachine {
 public:
  SimulatedMachine(const analysis::model::PlantModel& model, const SimulatedBenchSettings& settings,
                   const SimulatedTest& test);

  BenchDevices Devices() override;
  std::span<const std::byte> Memory() override;
  void RestoreMemory(std::span<const std::byte> memory) override;
  void BeginPhase(std::uint64_t key) override { bench_.BeginPhase(key); }
  void MountBlank(bool mounted) override { bench_.MountBlank(mounted); }
  void CycleMeasured(int cycle) override;

  /// For tests that put faults in.
  SimulatedBench& bench() { return bench_; }

 private:
  SimulatedBench bench_;
  BenchMemory memory_;
  SimulatedTest test_;
};

}  // namespace strainwave::bench
