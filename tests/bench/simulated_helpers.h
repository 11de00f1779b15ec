// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "analysis/model/plant_model.h"
#include "bench/devices/simulated/simulated_bench.h"

namespace strainwave::bench {

inline analysis::model::PlantModel ModelWithout(std::initializer_list<std::string_view> terms) {
  analysis::model::PlantModel model = analysis::model::DefaultPlantModel();
  for (const std::string_view term : terms) analysis::model::FindTerm(model, term).enabled = false;
  return model;
}

/// The plant as it is, read by a perfect measuring chain.
inline analysis::model::PlantModel PerfectlyMeasured() {
  return ModelWithout({"output_encoder_eccentricity", "output_encoder_position_error",
                       "output_encoder_interpolation", "input_encoder_eccentricity", "encoder_quantisation",
                       "encoder_noise", "torque_gain_error", "torque_nonlinearity", "torque_zero_drift",
                       "torque_noise", "slow_channel_noise", "motor_torque_constant",
                       "motor_current_offset"});
}

/// Steps a bench as a controller does.
class Driver {
 public:
  explicit Driver(SimulatedBench& bench, std::chrono::nanoseconds period = std::chrono::milliseconds(10))
      : bench_(bench), period_(period) {}

  void Steps(int count) {
    for (int i = 0; i < count; ++i) bench_.clock().SleepUntil(bench_.clock().Now() + period_);
  }
  void Wait(double time_s) {
    Steps(static_cast<int>(time_s / std::chrono::duration<double>(period_).count() + 0.5));
  }

  /// Both drives enabled, both brakes off.
  void BringUp(DriveMode mode) {
    bench_.driving_servo().Enable(mode);
    bench_.load_servo().Enable(DriveMode::kTorque);
    Steps(4);
    bench_.driving_servo().SetBrake(false);
    bench_.load_servo().SetBrake(false);
    Steps(1);
  }

  /// The input to a position, gently: at most 100 rad/s², so that the output's inertia stays below its drag.
  void MoveTo(double target_rad) {
    const double from_rad = bench_.driving_servo().Actual().position_rad;
    const double half = 0.5 * (target_rad - from_rad);
    const double duration_s = std::acos(-1.0) * std::sqrt(std::abs(half) / 100.0);
    const double period_s = std::chrono::duration<double>(period_).count();
    for (double t = period_s; t < duration_s; t += period_s) {
      bench_.driving_servo().CommandPosition(from_rad +
                                             half * (1.0 - std::cos(std::acos(-1.0) * t / duration_s)));
      Steps(1);
    }
    bench_.driving_servo().CommandPosition(target_rad);
    Wait(0.3);
  }

  /// Input locked by its brake, load servo free to pull.
  void LockInput() {
    bench_.driving_servo().SetBrake(true);
    bench_.driving_servo().Disable();
    bench_.load_servo().Enable(DriveMode::kTorque);
    Steps(4);
    bench_.load_servo().SetBrake(false);
    Wait(0.1);
  }

  /// Load torque to `target_Nm` at a rate.
  void Ramp(double& torque_Nm, double target_Nm, double rate_Nm_per_s) {
    const double step = rate_Nm_per_s * std::chrono::duration<double>(period_).count();
    while (torque_Nm != target_Nm) {
      torque_Nm += std::clamp(target_Nm - torque_Nm, -step, step);
      bench_.load_servo().CommandTorque(torque_Nm);
      Steps(1);
    }
  }

 private:
  SimulatedBench& bench_;
  std::chrono::nanoseconds period_;
};

}  // namespace strainwave::bench
