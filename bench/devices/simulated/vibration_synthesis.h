// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "analysis/model/vibration.h"
#include "bench/devices/simulated/noise_source.h"
#include "bench/devices/simulated/resonator.h"
#include "bench/devices/simulated/vibration_cause_synthesis.h"
#include "bench/roles/sampler.h"

namespace strainwave::bench {

/// Makes the samples of the four accelerometers from the motion of the wave generator: order-tracked lines
/// at 1, 2, 4 and 2.025 per input turn; tooth mesh at 160 and 162 per input turn with sidebands at two per
/// input turn and one per output turn; three resonances rung by friction noise and mesh impacts; broadband
/// and sensor noise; and what defects add. Amplitudes follow speed, load, temperature and wear
/// (analysis/model/vibration.h).
class VibrationSynthesis {
 public:
  /// @param ratio   of the gear, input turns per output turn.
  /// @param seed    of the specimen and its sensors: decides the slow drift of their sensitivity.
  VibrationSynthesis(const analysis::model::Vibration& vibration, double ratio, std::uint64_t seed,
                     const analysis::model::VibrationCauses& causes = {});

  /// Starts a recording; `key` seeds its noise. Room for `capacity_s` between two drains.
  void Start(double sample_rate_hz, std::uint64_t key, double bench_time_s, double capacity_s);
  void Stop() noexcept { running_ = false; }
  bool running() const noexcept { return running_; }

  /// Makes the samples that fall into a step, over which the input turned from one angle to the other.
  /// Samples beyond the room are lost, and counted.
  void Advance(double step_s, double from_rad, double to_rad,
               const analysis::model::VibrationSources& sources) noexcept;

  void Drain(VibrationBlock& block);
  std::uint64_t lost_samples() const noexcept { return lost_; }

 private:
  void TuneResonators(const analysis::model::VibrationSources& sources) noexcept;
  void DriftAt(double bench_time_s) noexcept;

  analysis::model::Vibration vibration_;
  VibrationCauseSynthesis causes_;
  double ratio_;
  std::uint64_t seed_;
  bool running_{};
  double sample_rate_hz_{};
  double next_sample_s_{};  // from the start of the coming step
  NoiseSource noise_;
  std::array<double, analysis::model::kVibrationChannels> sensitivity_{};
  std::array<double, analysis::model::kVibrationOrders + analysis::model::kVibrationModes> run_factor_{};
  // Cosine and sine of each order's phase times its gain, by channel.
  std::array<std::array<double, analysis::model::kVibrationOrders>, analysis::model::kVibrationChannels>
      in_phase_{};
  std::array<std::array<double, analysis::model::kVibrationOrders>, analysis::model::kVibrationChannels>
      quadrature_{};
  std::array<Resonator, analysis::model::kVibrationModes> resonators_{};
  std::array<double, analysis::model::kVibrationModes> tuned_Hz_{};
  std::array<std::vector<float>, analysis::model::kVibrationChannels> samples_;
  std::size_t capacity_{};
  std::uint64_t lost_{};
};

}  // namespace strainwave::bench
