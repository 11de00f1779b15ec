// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/model_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/separable_study.h"
#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/led_axis.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis::diagnosis_model_uncertainty_test {
namespace {

constexpr std::size_t kSamples = 1000;
constexpr double kNoise = 0.1;
constexpr double kAllowed = 0.01;

// Impacts for ten samples of every hundred.
bool Impacts(std::size_t sample) { return sample % 100 < 10; }

SeparableTerm Column(const std::vector<double>& values) {
  SeparableTerm term;
  term.fill = [values](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) {
    for (std::size_t i = 0; i < values.size(); ++i) design(static_cast<Eigen::Index>(i), 0) = values[i];
  };
  DescribeEach(term, {{"size", "1", 1.0}});
  return term;
}

// A mean; impacts of one height, of which each may be wrong by all of it; and something else.
SeparableStudy Toy(std::vector<double> measured, std::vector<double> else_values) {
  std::vector<double> impacts;
  for (std::size_t i = 0; i < kSamples; ++i) impacts.push_back(Impacts(i) ? 1.0 : 0.0);
  SeparableModel model;
  model.nominal.push_back(Column(std::vector<double>(kSamples, 1.0)));
  model.causes.push_back(Column(impacts));
  model.causes.back().model_uncertainty = [impacts](std::span<const double> numbers) -> Eigen::VectorXd {
    return std::abs(numbers[0]) * Eigen::Map<const Eigen::VectorXd>(impacts.data(), kSamples);
  };
  model.rules.push_back({.name = "knocks", .parameters = {{"size", "1", -10.0, 10.0, true}}});
  model.causes.push_back(Column(std::move(else_values)));
  model.rules.push_back({.name = "else", .parameters = {{"size", "1", -10.0, 10.0, true}}});
  model.measured = std::move(measured);
  model.block_length = kSamples / 20;
  model.noise_floor = kNoise;
  return SeparableStudy(std::move(model));
}

// Whether what is found beside the impacts is uncertain.
bool IsElseUncertain(const SeparableStudy& study) {
  const Judge judge(study, std::vector<double>(kSamples, 1.0), {});
  const std::vector<std::size_t> impacts{0};
  const std::vector<std::size_t> both{0, 1};
  const ScoredModel without = judge.Fit(impacts, nullptr);
  const ScoredModel with = judge.Fit(both, &without.fit);
  EXPECT_GT(judge.Compare(with, without).likelihood_ratio, 30.0);
  return IsUncertain(judge, with, without, 1, kAllowed);
}

// One impact of ten is what else there is.
std::vector<double> OneImpact() {
  std::vector<double> one(kSamples, 0.0);
  for (std::size_t i = 400; i < 410; ++i) one[i] = 1.0;
  return one;
}

TEST(ModelUncertainty, LeavesNothingOfWhatIsBuiltOnOneImpactWhereAllAreOffByChance) {
  std::vector<double> measured = WhiteNoise(kSamples, kNoise, 1);
  const std::vector<double> astray = WhiteNoise(kSamples, 0.6, 2);
  for (std::size_t i = 0; i < kSamples; ++i) measured[i] += Impacts(i) ? 1.5 + astray[i] : 0.0;
  for (std::size_t i = 400; i < 410; ++i) measured[i] += 0.5;
  EXPECT_TRUE(IsElseUncertain(Toy(std::move(measured), OneImpact())));
}

TEST(ModelUncertainty, TakesNothingFromWhatIsThereBetweenTheImpacts) {
  std::vector<double> measured = WhiteNoise(kSamples, kNoise, 3);
  const std::vector<double> astray = WhiteNoise(kSamples, 0.6, 4);
  std::vector<double> wave;
  for (std::size_t i = 0; i < kSamples; ++i) {
    wave.push_back(std::sin(kTwoPi * static_cast<double>(i) / 25.0));
    measured[i] += (Impacts(i) ? 1.5 + astray[i] : 0.0) + 0.1 * wave[i];
  }
  EXPECT_FALSE(IsElseUncertain(Toy(std::move(measured), wave)));
}

// As predicted but for what else there is: in all impacts from the sixth on, or in one.
std::vector<double> LaterImpacts() {
  std::vector<double> later;
  for (std::size_t i = 0; i < kSamples; ++i) later.push_back(Impacts(i) && i >= kSamples / 2 ? 1.0 : 0.0);
  return later;
}

TEST(ModelUncertainty, SaysNothingWhereSeveralImpactsTell) {
  const std::vector<double> later = LaterImpacts();
  std::vector<double> measured = WhiteNoise(kSamples, kNoise, 5);
  for (std::size_t i = 0; i < kSamples; ++i) measured[i] += (Impacts(i) ? 1.5 : 0.0) + 0.5 * later[i];
  EXPECT_FALSE(IsElseUncertain(Toy(std::move(measured), later)));
}

TEST(ModelUncertainty, LeavesNothingOfWhatOneImpactTells) {
  std::vector<double> measured = WhiteNoise(kSamples, kNoise, 6);
  for (std::size_t i = 0; i < kSamples; ++i) measured[i] += Impacts(i) ? 1.5 : 0.0;
  for (std::size_t i = 400; i < 410; ++i) measured[i] += 0.5;
  EXPECT_TRUE(IsElseUncertain(Toy(std::move(measured), OneImpact())));
}

// An axis with a light load in a gap so wide that the load strikes several times on its way; when depends on
// when it struck before.
const LedAxis kWideGap{.path = {{1.5, kTwoPi * 0.07}, {0.4, kTwoPi * 0.33}, {0.15, kTwoPi * 0.9}},
                       .duration_s = 27.0,
                       .step_s = 2e-5,
                       .each = 200,
                       .inertia_kgm2 = 0.29,
                       .viscous_Nms_per_rad = 0.175,
                       .coulomb_Nm = 0.164,
                       .load_kgm2 = 0.0153,
                       .half_gap_rad = 0.155,
                       .load_friction_per_s2 = 0.3,
                       .contact_rad_per_s = kTwoPi * 28.5,
                       .contact_damping = 0.38,
                       .torque_noise_Nm = 0.0387,
                       .position_noise_rad = 2e-7};

TEST(ModelUncertainty, NamesNoDisturbanceAtImpactsThatComeAtAnotherTime) {
  for (const unsigned seed : {1U, 2U}) {
    const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {RecordOf(kWideGap, seed)});
    EXPECT_EQ(found.names(), Names{"backlash"}) << seed;
  }
}

// Friction that turns round at all reversals with the motion, and at one of them a little before it, as
// where an axis sticks for a moment.
MotionData OneEarlyReversal(unsigned seed, int which, double early_s) {
  const SinePath path{{1.2 / (kTwoPi * 0.13), kTwoPi * 0.13}, {0.4 / (kTwoPi * 0.41), kTwoPi * 0.41}};
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  int reversals = 0;
  for (int i = 0; i < 4300; ++i) {
    const double time_s = 0.01 * i;
    const PathState at = StateOn(path, time_s);
    if (i > 0 && at.speed_rad_per_s * StateOn(path, time_s - 0.01).speed_rad_per_s < 0.0) ++reversals;
    const PathState turned = reversals == which ? StateOn(path, time_s + early_s) : at;
    record.time_s.push_back(time_s);
    record.position.push_back(at.position_rad + 3e-6 * normal(random));
    record.torque.push_back(0.58 * at.acceleration_rad_per_s2 + 5.7 * at.speed_rad_per_s +
                            std::copysign(19.0, turned.speed_rad_per_s) + 0.27 * normal(random));
  }
  return record;
}

TEST(ModelUncertainty, NamesNothingForOneReversalThatComesEarly) {
  for (const unsigned seed : {4U, 5U}) {
    for (const int which : {2, 3, 4}) {
      for (const double early_s : {0.01, 0.014}) {
        EXPECT_EQ(DiagnoseRecords(&MakeMotionStudy, {OneEarlyReversal(seed, which, early_s)}).names(),
                  Names())
            << seed << " " << which << " " << early_s;
      }
    }
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_model_uncertainty_test
