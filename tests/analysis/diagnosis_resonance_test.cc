// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "analysis/diagnosis/vibration/bands.h"
#include "analysis/diagnosis/vibration/impulse_train.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/solver.h"
#include "analysis/units.h"
#include "tests/analysis/vibration_record.h"

namespace strainwave::analysis::diagnosis::diagnosis_resonance_test {
namespace {

constexpr double kFrequency_Hz = 200.0;
constexpr double kDamping = 0.012;

// A resonance that noise keeps swinging.
Effect Swing(double deviation_m_per_s2, unsigned seed = 77) {
  return [=](const Turning& run) {
    const double angle = kTwoPi * kFrequency_Hz / kRate_Hz;
    const double radius = std::exp(-kDamping * angle);
    std::mt19937 random(seed);
    std::normal_distribution<double> unrest;
    Signal signal;
    double before = 0.0;
    double before_that = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < run.time_s.size(); ++i) {
      const double now =
          2.0 * radius * std::cos(angle) * before - radius * radius * before_that + unrest(random);
      before_that = std::exchange(before, now);
      square += now * now;
      signal.push_back(now);
    }
    const double scale = deviation_m_per_s2 / std::sqrt(square / static_cast<double>(signal.size()));
    for (double& value : signal) value *= scale;
    return signal;
  };
}

// Each of the four channels alone shows next to nothing of it.
TEST(VibrationResonance, NamesAResonanceThatTheChannelsShowTogether) {
  const Effect swing = Swing(0.06 * kNoise_m_per_s2);
  const Turning run(1500.0, 2.0, 0.0);
  EXPECT_EQ(Ask({Record(run, 31, swing)}).names(), Names());
  const Diagnosed answer = Ask({Record(run, 31, swing, {1.0, 0.9, -1.0, 1.0})});
  EXPECT_EQ(answer.names(), Names{"torsional_resonance"});
  EXPECT_NEAR(answer.value("frequency_Hz").value, kFrequency_Hz, 3.0);
}

// A few cells of the spectrum hold it all, and one of them most: it looks like a tone, and less damped than
// it is.
TEST(VibrationResonance, NamesWhatSwingsInAShortRecord) {
  for (const unsigned seed : {1U, 2U, 24U, 30U, 37U, 38U}) {
    const Effect swing = Swing(0.2 * kNoise_m_per_s2, seed + 70);
    EXPECT_EQ(Ask({Record(Turning(1430.0, 0.7, 0.0), seed, swing)}).names(), Names{"torsional_resonance"})
        << seed;
  }
}

// No band shows them, the largest bursts are chance, and so is what a line takes of them.
TEST(VibrationResonance, NamesAFewImpacts) {
  const Effect impacts = Ringing(211.9, 0.0157, {{0.313, 0.09}, {0.952, -0.08}});
  for (const unsigned seed : {1U, 2U, 3U, 17U, 18U, 22U}) {
    EXPECT_EQ(Ask({Record(Turning(1500.0, 1.2, 0.0), seed, impacts)}).names(), Names{"torsional_resonance"})
        << seed;
  }
}

TEST(FindBands, SaysHowTheChannelsMove) {
  const VibrationData record =
      Record(Turning(1500.0, 2.0, 0.0), 32, Swing(0.4 * kNoise_m_per_s2), {1.0, -0.5});
  const VibrationSamples samples = PrepareVibration({&record, 1});
  const std::vector<double> weights(samples.measured.size(), 1.0);
  const VibrationSolver solver(samples, weights);
  const VibrationSolution base = solver.Solve({});
  const std::vector<NoiseBand> bands = FindBands(VibrationResidual(samples, solver, base), 3.0, 2000.0, 2);
  ASSERT_FALSE(bands.empty());
  EXPECT_NEAR(bands[0].centre_Hz, kFrequency_Hz, 5.0);
  ASSERT_EQ(bands[0].sizes.size(), 2U);
  // The band holds the greater part of the power.
  EXPECT_GT(std::abs(bands[0].sizes[0]), std::sqrt(0.5) * 0.4);
  EXPECT_LT(std::abs(bands[0].sizes[0]), 0.45);
  EXPECT_NEAR(bands[0].sizes[1] / bands[0].sizes[0], -0.5, 0.1);
}

// One impact of a resonance that hardly dies away would need fewer numbers than a line with a phase a
// channel.
TEST(VibrationResonance, CallsAHumThatMovesAllChannelsInStepUnnamed) {
  const Effect hum = [](const Turning& run) {
    Signal signal;
    for (const double time : run.time_s) signal.push_back(0.02 * std::sin(kTwoPi * 60.0 * time + 0.3));
    return signal;
  };
  for (const unsigned seed : {33U, 34U}) {
    const Diagnosed answer = Ask({Record(Turning(1490.0, 1.34, 0.0), seed, hum, {0.85, 0.98, 0.78, 1.0})});
    EXPECT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure) << seed;
    EXPECT_EQ(answer.names(), Names()) << seed;
  }
}

// Two impacts within half a period of each other ring as one: told apart, neither would have a height.
TEST(VibrationResonance, NamesImpactsThatOverlap) {
  const Effect impacts =
      Ringing(126.9, 0.0125, {{0.61832, 0.10}, {0.64205, 0.144}, {0.64318, -0.1225}, {0.72612, -0.164}});
  for (const unsigned seed : {35U, 36U, 43U}) {
    const Diagnosed answer = Ask({Record(Turning(330.0, 2.254, 0.0), seed, impacts, {0.54, 1.0, 0.39})});
    EXPECT_EQ(answer.names(), Names{"torsional_resonance"}) << seed;
  }
}

TEST(OneOf, RingsAsTwoDoOnceBothHaveBegun) {
  const Turning run(1500.0, 0.2, 0.0);
  Signal two = Silence(run);
  AddRinging(run, 0.0101, 1.0, kFrequency_Hz, kDamping, two);
  AddRinging(run, 0.0112, -0.8, kFrequency_Hz, kDamping, two);
  const Impact impact = OneOf({0.0101, 1.0}, {0.0112, -0.8}, kFrequency_Hz, kDamping);
  EXPECT_NEAR(impact.start_s, 0.0101, 0.25 / kFrequency_Hz);
  Signal one = Silence(run);
  AddRinging(run, impact.start_s, impact.height, kFrequency_Hz, kDamping, one);
  for (std::size_t i = 70; i < one.size(); ++i) ASSERT_NEAR(one[i], two[i], 1e-3) << i;
}

// A band takes up something of the noise's colour, which a line cannot.
TEST(VibrationResonance, CallsAHumInColouredNoiseUnnamed) {
  const Effect hum = [](const Turning& run) {
    Signal signal;
    for (const double time : run.time_s) signal.push_back(0.4 * std::sin(kTwoPi * 60.0 * time + 0.3));
    return signal;
  };
  const Turning run(2225.0, 1.5, 0.0);
  for (const unsigned seed : {39U, 112U, 114U}) {
    VibrationData record = Record(run, seed, hum, {0.5, 1.0});
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
      const Signal noise = ColouredNoise(run, 100 * seed + static_cast<unsigned>(c), 0.5, 0.6);
      record.channels[c].values = std::move(record.channels[c].values) + noise;
    }
    const Diagnosed answer = Ask({record});
    EXPECT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure) << seed;
    EXPECT_EQ(answer.names(), Names()) << seed;
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_resonance_test
