// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>

#include "analysis/model/plant_model.h"
#include "bench/devices/simulated/plant_state.h"
#include "bench/devices/simulated/simulated_drive.h"
#include "bench/roles/bench_clock.h"
#include "bench/roles/sampler.h"
#include "bench/roles/servo_drive.h"

namespace strainwave::bench {

struct SimulatedBenchSettings {
  std::uint64_t seed{1};  // decides the specimen, its mounting, and all noise
  /// The output encoder is sampled so long after the input encoder; below zero: before (docs/effects.md E20).
  double time_skew_s{10e-6};
  /// Times real time; infinity: as fast as it can.
  double pace{std::numeric_limits<double>::infinity()};
  bool has_accelerometers{true};         // without them nothing of the vibration is read
  std::optional<double> ambient_degC{};  // mean of the room, and of everything at the start; else the model's
};

/// What a power cut leaves of the bench: the mechanics, the temperatures and the wear.
struct BenchMemory {
  PlantState plant;
};
static_assert(std::is_trivially_copyable_v<BenchMemory>);

/// Faults put in by a test. Channels are bits as in `Readings::bad_channels`.
struct Injection {
  unsigned frozen_channels{};    // repeat their last value and look good
  unsigned dead_channels{};      // repeat their last value and are reported bad
  unsigned drifting_channels{};  // go off by so much a second from the injection on, and look good
  double drift_per_s{};          // SI unit of the channel
  bool sampler_silent{};         // readings no longer come in at all, time stamp included
  bool quick_stop_pressed{};     // the operator's key
  bool driving_fault{};
  bool load_fault{};
  DriveFaults driving{};
  DriveFaults load{};
  std::optional<double> gear_temperature_degC{};  // set once, at the injection
};

/// What is true of the gear at this moment, for tests and the truth file; no measuring chain is in it.
struct BenchTruth {
  double k1_Nm_per_rad{};  // gear alone, mean over the angle of the wave generator
  double k2_Nm_per_rad{};
  double k3_Nm_per_rad{};
  double series_compliance_rad_per_Nm{};
  double hysteresis_rad{};  // width of the gear's loop at zero torque
  double friction_torque_Nm{};
  double e_avg_rad{};  // of the kinematic error at the standstills of a cw sweep, zeroed at the first
  double e_max_rad{};
  analysis::model::WearState wear;
  double input_revolutions{};
  double gear_temperature_degC{};
  double time_s{};
};

/// The embedded bench: 750 W servo with brake, gear, transducer, 1:70 planetary, load servo, two encoders and
/// four accelerometers, on a virtual clock. Seen through the roles only, as hardware is.
/// Same settings, same calls: the same bits.
class SimulatedBench {
 public:
  /// @throws std::invalid_argument for a model that does not compile (CompilePlantModel), a pace that is not
  ///   above zero, or a skew that is not finite.
  SimulatedBench(const analysis::model::PlantModel& model, const SimulatedBenchSettings& settings);
  SimulatedBench(const SimulatedBench&) = delete;
  SimulatedBench& operator=(const SimulatedBench&) = delete;
  ~SimulatedBench();

  ServoDrive& driving_servo();
  /// Torque and speed at the output of its reducer, where its position is told, too; it has no position mode.
  ServoDrive& load_servo();
  Sampler& sampler();
  BenchClock& clock();

  /// The noise from here on is that of (seed, key): a phase that is run again sees the same noise again.
  void BeginPhase(std::uint64_t key);

  BenchMemory Memory() const;
  /// As after a power cut at the time of `memory`: shafts at rest, torque off, brakes on.
  void RestoreAfterPowerCut(const BenchMemory& memory);

  /// Puts a rigid blank in the gear's place, or the gear back. At standstill only: all torque is gone after
  /// it. The fixture clamps the blank to the frame while the input brake is on.
  void MountBlank(bool mounted);

  void Inject(const Injection& injection);

  /// @param step_rad, steps  of the sweep, as in the schedule.
  /// @param start_input_rad  where it starts; by default at the zero of the output encoder nearest to where
  ///   the output stands.
  BenchTruth TruthNow(double step_rad, int steps, std::optional<double> start_input_rad = std::nullopt) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace strainwave::bench
