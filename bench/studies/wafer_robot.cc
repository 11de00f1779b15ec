// SPDX-License-Identifier: Apache-2.0
#include "bench/studies/wafer_robot.h"

#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <random>

#include <fmt/format.h>

#include "analysis/model/wafer_axis.h"
#include "analysis/units.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/errors/bench_error.h"
#include "daq/csv_record.h"
#include "daq/data_file_error.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace model = analysis::model;

constexpr int kUnits = 4;
constexpr int kCycles = 25;
constexpr int kVibrationRecordings = 5;
constexpr std::array kWornShares{0.0, 1.0 / 6.0, 1.0 / 3.0};
constexpr std::array kDamagedTeeth{0, 7, 14, 21};

// Seeds of parts that do not depend on what was drawn before.
std::uint64_t MixedSeed(std::uint64_t seed, std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  std::uint64_t mixed = seed;
  for (const std::uint64_t part : {a, b, c}) {
    mixed ^= part + 0x9e3779b97f4a7c15ULL + (mixed << 6U) + (mixed >> 2U);
    mixed *= 0xbf58476d1ce4e5b9ULL;
    mixed ^= mixed >> 31U;
  }
  return mixed;
}

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double Even() { return (static_cast<double>(engine_() >> 11U) + 0.5) * 0x1p-53; }
  double Normal() {
    const double radius = std::sqrt(-2.0 * std::log(Even()));
    return radius * std::cos(kTwoPi * Even());
  }
  // A factor about 1 with this standard deviation, never out of range.
  double Factor(double deviation) { return std::exp(deviation * std::min(2.5, std::max(-2.5, Normal()))); }

 private:
  std::mt19937_64 engine_;
};

struct Assembly {
  model::WaferAxis axis;
  double current_gain{1.0};
  double current_offset_A{};
};

// One mounting of one robot in one condition.
Assembly DrawAssembly(std::size_t hd, std::size_t tb, std::uint64_t seed) {
  Draw draw(seed);
  Assembly assembly;
  model::WaferAxis& axis = assembly.axis;
  const double friction = draw.Factor(0.12);
  axis.friction.coulomb_Nm *= 0.6 * friction;
  axis.friction.breakaway_Nm *= 0.6 * friction;
  axis.friction.flexspline_Nm *= 0.6 * friction;
  axis.friction.viscous_floor_Nms_per_rad *= draw.Factor(0.1);
  axis.friction.periodic_share_1 *= draw.Factor(0.3);
  axis.friction.periodic_share_2 *= draw.Factor(0.3);
  const double stiffness = draw.Factor(0.05);
  axis.spring.k1_Nm_per_rad *= stiffness;
  axis.spring.k2_Nm_per_rad *= stiffness;
  axis.spring.k3_Nm_per_rad *= stiffness;
  for (double& amplitude : axis.kinematic_error.amplitude_rad) amplitude *= draw.Factor(0.25);
  for (double& phase : axis.kinematic_error.phase_rad) phase = kTwoPi * draw.Even();
  axis.belt_stiffness_Nm_per_rad *= draw.Factor(0.06);
  axis.belt_play_rad *= draw.Factor(0.2);
  axis.belt_tooth_error_rad *= draw.Factor(0.2);
  axis.worn_share = kWornShares[hd] * draw.Factor(hd > 0 ? 0.05 : 0.0);
  axis.worn_phase_rad = kTwoPi * draw.Even();
  axis.worn_error_rad *= draw.Factor(0.1);
  axis.damaged_belt_teeth = kDamagedTeeth[tb];
  axis.damaged_tooth_error_rad *= draw.Factor(0.1);
  axis.damaged_play_rad *= draw.Factor(0.1);
  axis.temperature_degC = 30.0 + 3.0 * draw.Normal();
  axis.vertical_gain_per_kgm *= draw.Factor(0.04);
  assembly.current_gain = draw.Factor(0.01);
  assembly.current_offset_A = 0.02 * draw.Normal();
  return assembly;
}

// A cycle of it: the controller's clock and the temperature wander.
model::WaferCycle CycleOf(const Assembly& assembly, double move_s, std::uint64_t seed) {
  Draw draw(seed);
  model::WaferAxis axis = assembly.axis;
  axis.temperature_degC += 0.5 * draw.Normal();
  const double friction = draw.Factor(0.02);
  axis.friction.coulomb_Nm *= friction;
  model::WaferMotion motion;
  motion.move_s = move_s * draw.Factor(0.01);
  motion.first_start_s += 0.004 * draw.Normal();
  motion.second_start_s += 0.004 * draw.Normal();
  motion.cycle_s = 2.4 + 0.02 * draw.Normal();
  model::WaferCycle cycle = model::SimulateWaferCycle(axis, motion, {}, seed + 1);
  for (double& current_A : cycle.current_A)
    current_A = assembly.current_gain * current_A + assembly.current_offset_A;
  return cycle;
}

// As the controller's log has it: four digits behind the point of the current, three of the speed.
daq::Record RecordOf(model::WaferCycle cycle) {
  for (double& value : cycle.current_A) value = std::round(value * 1e4) / 1e4;
  for (double& value : cycle.velocity_rad_per_s) value = std::round(value * 1e3) / 1e3;
  daq::Record record;
  record.kind = daq::RecordKind::kMotor;
  record.SetMetadata("sample_rate_hz", model::kWaferMotorRate_hz);
  record.columns = {{"current_A", std::move(cycle.current_A), "", ""},
                    {"velocity_rad_per_s", std::move(cycle.velocity_rad_per_s), "", ""},
                    {"state", std::move(cycle.state), "", ""}};
  return record;
}

struct Job {
  std::size_t hd{};
  std::size_t tb{};
  int unit{};
  std::array<double, kVibrationRecordings> rms{};
  std::vector<std::string> files;
  bool failed{};
};

std::string HealthText(std::size_t level, std::size_t most) {
  return daq::ShortestText(std::round(1e4 * static_cast<double>(level) / static_cast<double>(most)) / 1e4);
}

StudySummary MakeRobots(const StudySettings& settings, double move_s) {
  const int units = settings.units.value_or(kUnits);
  std::vector<Job> jobs;
  for (std::size_t hd = 0; hd < kWornShares.size(); ++hd) {
    for (std::size_t tb = 0; tb < kDamagedTeeth.size(); ++tb) {
      for (int unit = 0; unit < units; ++unit) jobs.push_back({hd, tb, unit, {}, {}, false});
    }
  }
  const std::filesystem::path records = settings.out / "records";
  std::filesystem::create_directories(records);
  std::mutex telling;
  std::size_t done = 0;
  const std::size_t all = jobs.size() * kCycles;
  OnAllProcessors(jobs.size(), [&](std::size_t k) {
    Job& job = jobs[k];
    const std::uint64_t condition = job.hd * kDamagedTeeth.size() + job.tb;
    const auto number = static_cast<std::uint64_t>(job.unit);
    const Assembly assembly = DrawAssembly(job.hd, job.tb, MixedSeed(settings.seed, condition, number, 0));
    // Vibration is of other cycles than the motor's records.
    for (std::size_t i = 0; i < job.rms.size() && !job.failed; ++i) {
      const model::WaferCycle cycle =
          CycleOf(assembly, move_s, MixedSeed(settings.seed, condition, number, 1000 + i));
      job.rms[i] = cycle.vertical_rms_m_per_s2;
      job.failed = cycle.failed;
    }
    for (int i = 0; i < kCycles; ++i) {
      if (!job.failed) {
        model::WaferCycle cycle = CycleOf(
            assembly, move_s, MixedSeed(settings.seed, condition, number, 1 + static_cast<std::uint64_t>(i)));
        job.failed = cycle.failed;
        const std::string name =
            fmt::format("records/hd{}_tb{}_{}_{:03}.csv", job.hd, job.tb, job.unit + 1, i + 1);
        if (!job.failed) {
          daq::WriteCsvRecord(RecordOf(std::move(cycle)), settings.out / name);
          job.files.push_back(name);
        }
      }
      const std::lock_guard lock(telling);
      settings.progress(++done, all);
    }
  });
  LabelsWriter labels({"health_hd", "health_tb", "system_rms"});
  std::string failed = "unit,health_hd,health_tb\n";
  bool any_failed = false;
  for (const Job& job : jobs) {
    const std::string hd = HealthText(job.hd, kWornShares.size() - 1);
    const std::string tb = HealthText(job.tb, kDamagedTeeth.size() - 1);
    const std::string unit = fmt::format("hd{}_tb{}_{}", job.hd, job.tb, job.unit + 1);
    if (job.failed) {
      any_failed = true;
      failed += fmt::format("{},{},{}\n", unit, hd, tb);
    }
    for (std::size_t i = 0; i < job.files.size(); ++i) {
      const std::string rms =
          i < job.rms.size() ? daq::ShortestText(std::round(1e5 * job.rms[i]) / 1e5) : std::string();
      labels.Add(job.files[i], unit, {hd, tb, rms});
    }
  }
  if (any_failed) {
    try {
      daq::WriteFileAtomically(settings.out / "failed_conditions.csv", failed);
    } catch (const daq::DataFileError& error) {
      throw BenchError(ExitCode::kMachineFailed, error.what());
    }
  }
  return labels.Write(settings.out);
}

}  // namespace

StudySummary MakeWaferRobot(const StudySettings& settings) {
  return MakeRobots(settings, model::WaferMotion{}.move_s);
}

StudySummary MakeSlowWaferRobot(const StudySettings& settings) {
  return MakeRobots(settings, 1.5 * model::WaferMotion{}.move_s);
}

}  // namespace strainwave::bench
