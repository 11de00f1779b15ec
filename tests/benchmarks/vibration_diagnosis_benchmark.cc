// SPDX-License-Identifier: Apache-2.0
// CPU time that the diagnosis of a long vibration record with the impulses of a bearing takes. Run:
// build/benchmarks/vibration_diagnosis_benchmark --benchmark_repetitions=3
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>

#include <benchmark/benchmark.h>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/records.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kSamples = 81921;
constexpr double kRate_Hz = 20480.0;
constexpr double kTurn_Hz = 2000.0 / 60.0;

// Noise, and the shaft's lines at 1 and 2 per turn.
VibrationData Record() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, 0.5);
  std::uniform_real_distribution<double> uniform(0.1, 0.5);
  VibrationData record;
  record.input_speed_rad_per_s = {kTwoPi * kTurn_Hz};
  for (std::size_t i = 0; i < kSamples; ++i) record.time_s.push_back(static_cast<double>(i) / kRate_Hz);
  for (const char* name :
       {"accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2", "accel_motor_z_m_per_s2"}) {
    VibrationChannel& channel = record.channels.emplace_back(name);
    const std::array<double, 4> line{uniform(random), 10.0 * uniform(random), uniform(random),
                                     10.0 * uniform(random)};
    for (const double time_s : record.time_s) {
      const double angle = kTwoPi * kTurn_Hz * time_s;
      channel.values.push_back(normal(random) + line[0] * std::cos(angle + line[1]) +
                               line[2] * std::cos(2.0 * angle + line[3]));
    }
  }
  return record;
}

// An impulse at 9.9 per turn, which slips a little, lets a resonance at 3.9 kHz ring.
VibrationData RecordOfABearing() {
  constexpr double kApart_s = 1.0 / (9.9 * kTurn_Hz);
  constexpr double kRing_rad_per_s = kTwoPi * 3900.0;
  constexpr double kDamping = 0.03;
  VibrationData record = Record();
  std::mt19937 random(2);
  std::normal_distribution<double> slip_s(0.0, 0.002 * kApart_s);
  for (double even_s = 0.01; even_s < record.time_s.back(); even_s += kApart_s) {
    const double onset_s = even_s + slip_s(random);
    const auto first = static_cast<std::size_t>(std::ceil(onset_s * kRate_Hz));
    for (std::size_t i = first; i < std::min(first + 200, kSamples); ++i) {
      const double since = kRing_rad_per_s * (record.time_s[i] - onset_s);
      double gain = 0.2;
      for (VibrationChannel& channel : record.channels)
        channel.values[i] += (gain += 0.05) * std::exp(-kDamping * since) * std::sin(since);
    }
  }
  return record;
}

void DiagnosesVibration(benchmark::State& state, const VibrationData& record, Verdict expected) {
  for (auto _ : state) {
    const std::unique_ptr<Study> study = MakeVibrationStudy({&record, 1});
    const Diagnosis diagnosis = Diagnose(*study);
    if (diagnosis.verdict != expected) state.SkipWithError("another verdict");
  }
}
BENCHMARK_CAPTURE(DiagnosesVibration, bearing, RecordOfABearing(), Verdict::kEffectFound)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace strainwave::analysis::diagnosis
