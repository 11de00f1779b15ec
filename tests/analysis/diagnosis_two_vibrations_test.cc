// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include "analysis/diagnosis/vibration/chance.h"
#include "analysis/diagnosis/vibration/gear_mesh.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/units.h"
#include "tests/analysis/vibration_record.h"

namespace strainwave::analysis::diagnosis::diagnosis_two_vibrations_test {
namespace {

// Each line is as weak in each channel as noise may be; the weakest brings less than its numbers are charged,
// and no name.
TEST(VibrationPair, NamesAMeshThatIsWeakInFourChannelsBesideImpacts) {
  const struct {
    double amplitude;
    unsigned seed;
    Names mesh;
  } records[] = {
      {0.006, 1, {}}, {0.008, 1, {"gear_mesh"}}, {0.007, 2, {"gear_mesh"}}, {0.008, 2, {"gear_mesh"}}};
  for (const auto& [amplitude, seed, mesh] : records) {
    const Effect both = [amplitude = amplitude](const Turning& run) {
      Signal signal = Line(run, 160.0, amplitude) + Line(run, 162.0, amplitude);
      for (const double start_s : {0.2, 0.61}) AddRinging(run, start_s, 1.0, 94.0, 0.01, signal);
      return signal;
    };
    const Diagnosed answer = Ask({Record(Turning(700.0, 1.5, 0.0), seed, both, {1.0, 0.9, 0.6, 0.8})});
    Names expected{"torsional_resonance"};
    expected.insert(expected.end(), mesh.begin(), mesh.end());
    EXPECT_EQ(answer.names(), expected) << amplitude << " " << seed;
  }
}

// The formula's train was there before the record, this one begins in it: what that leaves is an impact at
// the train's own frequency.
TEST(VibrationPair, TakesWhatATrainLeavesForNoResonance) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Effect train = [](const Turning& run) {
      constexpr double kOrder = 11.36;
      Signal signal = Silence(run);
      const double turn_s = run.time_s.back() / run.turns();
      for (double impact = 0.75; impact < run.turns() * kOrder; ++impact) {
        const double zones = 1.0 + 0.6 * std::cos(2.0 * kTwoPi * impact / kOrder + 0.3);
        AddRinging(run, impact / kOrder * turn_s, 0.6 * zones, 1265.0, 0.03, signal);
      }
      return signal;
    };
    EXPECT_EQ(Ask({Record(Turning(1874.0, 0.5, 0.0), seed, train)}).names(), Names{"bearing_defect"}) << seed;
  }
}

// In no channel alone: it takes all four.
TEST(WeakVibration, NamesACrackThatNoChannelShowsAlone) {
  const struct {
    double height;
    unsigned seed;
  } records[] = {{0.0029, 9}, {0.0024, 11}};
  for (const auto& [height, seed] : records) {
    const Effect crack = [height = height](const Turning& run) {
      constexpr double kWidth = 0.06;  // turns
      Signal signal;
      for (const double angle : run.angle_rad) {
        double pulse = 0.0;
        for (int k = 1; k <= 12; ++k)
          pulse += std::exp(-0.5 * std::pow(kTwoPi * kWidth * k, 2)) * std::cos(k * (2.025 * angle + 0.4));
        signal.push_back(height * pulse * (1.0 + 0.6 * std::cos(angle / 80.0 + 0.2)));
      }
      return signal;
    };
    EXPECT_EQ(Ask({Record(Turning(2000.0, 2.6, 0.0), seed, crack, {0.9, 1.0, 0.9, 0.5})}).names(),
              Names{"flexspline_crack"})
        << seed;
  }
}

TEST(WeakVibration, CallsALineThatNoChannelShowsAloneUnnamed) {
  const Effect line = [](const Turning& run) { return Line(run, 7.3, 0.0058); };
  const Diagnosed answer = Ask({Record(Turning(1500.0, 1.5, 0.0), 5, line, {0.9, 1.0, 0.9, 0.8})});
  EXPECT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure);
  EXPECT_EQ(answer.names(), Names());
}

TEST(ImprobabilityOf, IsTheLogarithmOfTheChanceThatNoiseHas) {
  // Two numbers have an exponential distribution; of others from a table of χ².
  EXPECT_NEAR(ImprobabilityOf(26.0, 2.0), 13.0, 1e-9);
  EXPECT_NEAR(ImprobabilityOf(31.410, 20.0), -std::log(0.05), 1e-3);
  EXPECT_NEAR(ImprobabilityOf(3.841, 1.0), -std::log(0.05), 1e-3);
  EXPECT_NEAR(ImprobabilityOf(2000.0, 2.0), 1000.0, 1e-9);
  EXPECT_NEAR(ImprobabilityOf(1000.1, 9.0), ImprobabilityOf(999.9, 9.0), 0.2);
  EXPECT_EQ(ImprobabilityOf(0.0, 3.0), 0.0);
}

// 35 turns: sidebands of the output turn do not stand apart, and beside 160 and 162 there are 158, 159, 161,
// 163 and 164.
TEST(LogChoicesOfMesh, CountsSetsOfLinesAndOfChannels) {
  const VibrationData record = Record(Turning(1400.0, 1.5, 0.0), 3, Silence, {1.0, 1.0, 1.0, 1.0});
  const VibrationSamples samples = PrepareVibration({&record, 1});
  VibrationTerm mesh{.form = VibrationForm::kLines,
                     .lines = {{0.0, 160.0}},
                     .nonlinear_parameters = {},
                     .observable = {1, 1, 1, 1}};
  EXPECT_NEAR(LogChoicesOfMesh(samples, mesh), 0.0, 1e-9);
  mesh.lines.push_back({0.0, 162.0});
  EXPECT_NEAR(LogChoicesOfMesh(samples, mesh), 0.0, 1e-9);
  mesh.lines.push_back({0.0, 163.0});
  const double one_of_others = LogChoicesOfMesh(samples, mesh);
  EXPECT_GT(one_of_others, std::log(4.9));
  mesh.observable = {1, 0, 0, 1};
  EXPECT_NEAR(LogChoicesOfMesh(samples, mesh), one_of_others + std::log(6.0), 1e-9);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_two_vibrations_test
