// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/simulated/vibration_synthesis.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "analysis/units.h"

namespace strainwave::bench {

namespace model = analysis::model;

namespace {

constexpr std::size_t kChannels = model::kVibrationChannels;
constexpr std::size_t kOrders = model::kVibrationOrders;
constexpr std::size_t kModes = model::kVibrationModes;
// Friction noise excites the resonances all the time, mesh impacts while the major axis of the wave generator
// passes. Together of mean square one: a² + 2ab·mean(max(0, cos)) + b²·mean(max(0, cos)²).
constexpr double kFrictionDrive = 0.7;
constexpr double kImpactDrive = 0.7923;
constexpr double kDriftPeriods_h[] = {19.0, 61.0, 173.0};

// A rotating unit vector: a multiplication a sample in the place of a sine and a cosine.
struct Phasor {
  double c{1.0}, s{0.0};

  static Phasor At(double angle_rad) noexcept { return {std::cos(angle_rad), std::sin(angle_rad)}; }
  Phasor operator*(const Phasor& other) const noexcept {
    return {c * other.c - s * other.s, c * other.s + s * other.c};
  }
};

}  // namespace

VibrationSynthesis::VibrationSynthesis(const model::Vibration& vibration, double ratio, std::uint64_t seed,
                                       const model::VibrationCauses& causes)
    : vibration_(vibration),
      causes_(causes, ratio, vibration.reference_speed_rad_per_s),
      ratio_(ratio),
      seed_(seed) {
  for (std::size_t channel = 0; channel < kChannels; ++channel) {
    for (std::size_t k = 0; k < kOrders; ++k) {
      const double gain = vibration_.order_gain[channel][k];
      in_phase_[channel][k] = gain * std::cos(vibration_.order_phase_rad[channel][k]);
      quadrature_[channel][k] = gain * std::sin(vibration_.order_phase_rad[channel][k]);
    }
  }
}

void VibrationSynthesis::DriftAt(double bench_time_s) noexcept {
  NoiseSource draw(NoiseKey(seed_, 0x5e4501));
  for (double& sensitivity : sensitivity_) {
    double drift = 0.0;
    for (const double period_h : kDriftPeriods_h) {
      drift += draw() * std::sin(kTwoPi * bench_time_s / SecondsFromHours(period_h)) +
               draw() * std::cos(kTwoPi * bench_time_s / SecondsFromHours(period_h));
    }
    sensitivity =
        1.0 + vibration_.sensor_drift * drift / std::sqrt(static_cast<double>(std::size(kDriftPeriods_h)));
  }
}

void VibrationSynthesis::Start(double sample_rate_hz, std::uint64_t key, double bench_time_s,
                               double capacity_s) {
  sample_rate_hz_ = sample_rate_hz;
  next_sample_s_ = 0.0;
  noise_ = NoiseSource(key);
  for (double& factor : run_factor_) factor = std::exp(vibration_.scatter_per_run * noise_());
  DriftAt(bench_time_s);
  causes_.Start(sample_rate_hz, key);
  resonators_ = {};
  tuned_Hz_ = {};
  lost_ = 0;
  capacity_ = static_cast<std::size_t>(capacity_s * sample_rate_hz) + 1;
  for (auto& channel : samples_) {
    channel.clear();
    channel.reserve(capacity_);
  }
  running_ = true;
}

void VibrationSynthesis::TuneResonators(const model::VibrationSources& sources) noexcept {
  for (std::size_t m = 0; m < kModes; ++m) {
    if (tuned_Hz_[m] == sources.mode_Hz[m]) continue;
    tuned_Hz_[m] = sources.mode_Hz[m];
    resonators_[m].Tune(tuned_Hz_[m], vibration_.mode_damping[m], sample_rate_hz_);
  }
}

void VibrationSynthesis::Advance(double step_s, double from_rad, double to_rad,
                                 const model::VibrationSources& sources) noexcept {
  if (!running_) return;
  const double period_s = 1.0 / sample_rate_hz_;
  if (next_sample_s_ >= step_s) {
    next_sample_s_ -= step_s;
    return;
  }
  TuneResonators(sources);
  const double per_sample_rad = (to_rad - from_rad) / step_s * period_s;
  const double start_rad = from_rad + (to_rad - from_rad) * (next_sample_s_ / step_s);
  Phasor input = Phasor::At(start_rad);
  Phasor output = Phasor::At(start_rad / ratio_);
  Phasor mesh = Phasor::At(std::fmod(160.0 * start_rad, kTwoPi));
  const Phasor input_turn = Phasor::At(per_sample_rad);
  const Phasor output_turn = Phasor::At(per_sample_rad / ratio_);
  const Phasor mesh_turn = Phasor::At(160.0 * per_sample_rad);

  std::array<double, kOrders> amplitude;
  for (std::size_t k = 0; k < kOrders; ++k) amplitude[k] = sources.order_m_per_s2[k] * run_factor_[k];
  // A mesh beyond half the sampling rate is taken out by the anti-aliasing filter.
  if (std::abs(per_sample_rad) * 164.0 > kPi) amplitude[4] = amplitude[5] = 0.0;
  std::array<double, kModes> mode;
  for (std::size_t m = 0; m < kModes; ++m) mode[m] = sources.mode_m_per_s2[m] * run_factor_[kOrders + m];
  const double noise_level = std::hypot(sources.broadband_m_per_s2, vibration_.sensor_noise_m_per_s2);
  const bool has_defects = causes_.any();
  const double speed_rad_per_s = (to_rad - from_rad) / step_s;
  double defect_rad = start_rad;

  for (; next_sample_s_ < step_s; next_sample_s_ += period_s) {
    const Phasor second = input * input;
    const Phasor fourth = second * second;
    const Phasor tooth = second * (output * output);
    const Phasor mesh_162 = mesh * second;
    const double modulation =
        (1.0 + sources.sideband_depth * second.c) * (1.0 + vibration_.output_modulation * output.c);
    const std::array<Phasor, kOrders> lines{input, second, fourth, tooth, mesh, mesh_162};
    std::array<double, kOrders> cosine;
    std::array<double, kOrders> sine;
    for (std::size_t k = 0; k < kOrders; ++k) {
      const double a = k < 4 ? amplitude[k] : amplitude[k] * modulation;
      cosine[k] = a * lines[k].c;
      sine[k] = a * lines[k].s;
    }
    // Impacts: noise let through while the major axis of the wave generator passes, twice a turn.
    const double random = noise_();
    const double drive = random * (kFrictionDrive + kImpactDrive * std::max(0.0, second.c));
    std::array<double, kModes> ringing;
    for (std::size_t m = 0; m < kModes; ++m) {
      ringing[m] = mode[m] * resonators_[m].Driven(drive);
    }
    VibrationCauseSynthesis::Sample defects{};
    if (has_defects) {
      defects = causes_.Next(defect_rad, speed_rad_per_s);
      defect_rad += per_sample_rad;
    }
    const bool room = samples_[0].size() < capacity_;
    if (!room) ++lost_;
    for (std::size_t channel = 0; channel < kChannels; ++channel) {
      double value = noise_level * noise_();
      for (std::size_t k = 0; k < kOrders; ++k) {
        value += in_phase_[channel][k] * cosine[k] - quadrature_[channel][k] * sine[k];
      }
      for (std::size_t m = 0; m < kModes; ++m) value += vibration_.mode_gain[channel][m] * ringing[m];
      if (has_defects) {
        value += vibration_.order_gain[channel][0] * defects.shaft_m_per_s2 +
                 vibration_.mode_gain[channel][0] * defects.housing_m_per_s2;
      }
      if (room) samples_[channel].push_back(static_cast<float>(sensitivity_[channel] * value));
    }
    input = input * input_turn;
    output = output * output_turn;
    mesh = mesh * mesh_turn;
  }
  next_sample_s_ -= step_s;
}

void VibrationSynthesis::Drain(VibrationBlock& block) {
  std::vector<float>* const targets[kChannels] = {&block.accel_x_m_per_s2, &block.accel_y_m_per_s2,
                                                  &block.accel_z_m_per_s2, &block.accel_motor_z_m_per_s2};
  for (std::size_t channel = 0; channel < kChannels; ++channel) {
    targets[channel]->insert(targets[channel]->end(), samples_[channel].begin(), samples_[channel].end());
    samples_[channel].clear();
  }
  block.lost_samples = lost_;
}

}  // namespace strainwave::bench
