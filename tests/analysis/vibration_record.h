// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

/// Records of an accelerometer for tests: shaft, effect and noise.
namespace strainwave::analysis::diagnosis {

inline constexpr double kRate_Hz = 5120.0;
inline constexpr double kNoise_m_per_s2 = 0.1;

/// Times, angles and speeds of the input shaft; the speed rises by `rise` of its mean from end to end.
struct Turning {
  std::vector<double> time_s;
  std::vector<double> angle_rad;
  std::vector<double> speed_rad_per_s;

  Turning(double speed_rpm, double duration_s, double rise) {
    const double mean = RadPerSFromRpm(speed_rpm);
    const auto count = static_cast<std::size_t>(duration_s * kRate_Hz);
    for (std::size_t i = 0; i < count; ++i) {
      const double time = static_cast<double>(i) / kRate_Hz;
      time_s.push_back(time);
      speed_rad_per_s.push_back(mean * (1.0 + rise * (time / duration_s - 0.5)));
      angle_rad.push_back(mean * time * (1.0 + 0.5 * rise * (time / duration_s - 1.0)));
    }
  }
  double turns() const { return angle_rad.back() / kTwoPi; }
};

using Signal = std::vector<double>;
using Effect = std::function<Signal(const Turning&)>;

inline Signal Silence(const Turning& run) { return Signal(run.time_s.size(), 0.0); }

inline Signal Line(const Turning& run, double order, double amplitude) {
  Signal signal;
  for (const double angle : run.angle_rad) signal.push_back(amplitude * std::cos(order * angle + 0.7));
  return signal;
}

/// A sine that dies away, from a time between two samples on.
inline void AddRinging(const Turning& run, double start_s, double height, double frequency_Hz, double damping,
                       Signal& signal) {
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const double since = kTwoPi * frequency_Hz * (run.time_s[i] - start_s);
    if (since >= 0.0 && damping * since < 9.0)
      signal[i] += height * std::exp(-damping * since) * std::sin(since);
  }
}

/// A start of a response and its height.
struct TestImpact {
  double start_s{};
  double height{};
};

/// A resonance that a few impacts excite.
inline Effect Ringing(double frequency_Hz, double damping, std::vector<TestImpact> impacts) {
  return [=, impacts = std::move(impacts)](const Turning& run) {
    Signal signal = Silence(run);
    for (const TestImpact& impact : impacts)
      AddRinging(run, impact.start_s, impact.height, frequency_Hz, damping, signal);
    return signal;
  };
}

inline Signal operator+(Signal a, const Signal& b) {
  std::transform(a.begin(), a.end(), b.begin(), a.begin(), std::plus<>());
  return a;
}

/// A channel with the shaft's two lines, the effect in it times a gain, and noise.
inline VibrationData Record(const Turning& run, unsigned seed, const Effect& effect,
                            const std::vector<double>& gains = {1.0}) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kNoise_m_per_s2);
  VibrationData record;
  record.time_s = run.time_s;
  const auto [slowest, fastest] = std::ranges::minmax(run.speed_rad_per_s);
  record.input_speed_rad_per_s = run.speed_rad_per_s;
  if (fastest - slowest < 1e-9) record.input_speed_rad_per_s.resize(1);
  const Signal hidden = effect(run);
  constexpr const char* kNames[] = {"accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2",
                                    "accel_motor_z_m_per_s2"};
  for (std::size_t c = 0; c < gains.size(); ++c) {
    VibrationChannel channel{kNames[c], Line(run, 1.0, 0.2) + Line(run, 2.0, 0.3)};
    for (std::size_t i = 0; i < hidden.size(); ++i) channel.values[i] += gains[c] * hidden[i] + noise(random);
    record.channels.push_back(std::move(channel));
  }
  return record;
}

inline Diagnosed Ask(const std::vector<VibrationData>& records) {
  return DiagnoseRecords(&MakeVibrationStudy, records);
}

/// First-order autoregressive noise.
inline Signal ColouredNoise(const Turning& run, unsigned seed, double deviation, double lag_one) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, deviation * std::sqrt(1.0 - lag_one * lag_one));
  Signal signal;
  double before = 0.0;
  for (std::size_t i = 0; i < run.time_s.size(); ++i)
    signal.push_back(before = lag_one * before + noise(random));
  return signal;
}

}  // namespace strainwave::analysis::diagnosis
