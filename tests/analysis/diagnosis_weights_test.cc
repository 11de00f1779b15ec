// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/heldout.h"
#include "analysis/diagnosis/noise_likelihood.h"
#include "analysis/diagnosis/selection.h"
#include "analysis/diagnosis/separable_study.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis::diagnosis_weights_test {
namespace {

constexpr std::size_t kSamples = 1000;
constexpr double kNoise = 0.1;
constexpr double kTimes = 6.0;  // as large is the noise of every other five samples

bool IsNoisy(std::size_t sample) { return sample % 10 < 5; }

std::vector<double> Weights() {
  std::vector<double> weights;
  for (std::size_t i = 0; i < kSamples; ++i) weights.push_back(IsNoisy(i) ? 1.0 / (kTimes * kTimes) : 1.0);
  return weights;
}

std::vector<double> Noise(unsigned seed) {
  std::vector<double> noise = WhiteNoise(kSamples, kNoise, seed);
  for (std::size_t i = 0; i < kSamples; ++i) noise[i] *= IsNoisy(i) ? kTimes : 1.0;
  return noise;
}

SeparableTerm Constant() {
  SeparableTerm term;
  term.fill = [](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) { design.setOnes(); };
  DescribeEach(term, {{"offset", "1", 1.0}});
  return term;
}

TEST(Weights, MakeTheNoiseThatOfASampleOfWeightOne) {
  const std::vector<std::size_t> segments{0};
  const NoiseFit fit = FitNoise(Noise(1), Weights(), segments, 4, 1.0);
  EXPECT_EQ(fit.order, 0);
  EXPECT_EQ(fit.samples, kSamples);
  EXPECT_NEAR(fit.innovation_sd, kNoise, 4.0 * kNoise / std::sqrt(2.0 * kSamples));
}

// A weighted mean's variance: noise² over the sum of weights.
TEST(Weights, CountInTheErrorsOfParameters) {
  const std::vector<double> weights = Weights();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(kSamples);
  const Eigen::MatrixXd covariance = ErrorsOfFit(Eigen::MatrixXd::Ones(kSamples, 1), Noise(2), zero, weights,
                                                 std::vector<std::size_t>{0}, 4, Eigen::VectorXd::Zero(1))
                                         .covariance;
  const double expected = kNoise / std::sqrt(500.0 + 500.0 / (kTimes * kTimes));
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), expected, 4.0 * expected / std::sqrt(2.0 * kSamples));
}

// What a study knows of its samples holds from the first fit to the last.
TEST(Weights, OfTheStudyHoldInItsDiagnosis) {
  SeparableModel model;
  model.nominal.push_back(Constant());
  model.measured = Noise(3);
  model.weights = Weights();
  model.noise_floor = kNoise;
  model.block_length = 50;
  model.spikes_are_outliers = false;
  double weighted = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    weighted += model.weights[i] * model.measured[i];
    all += model.weights[i];
  }
  const Diagnosis diagnosis = Diagnose(SeparableStudy(std::move(model)));
  EXPECT_EQ(diagnosis.weights, Weights());
  EXPECT_NEAR(diagnosis.nominal.nominal.front().value, weighted / all, 1e-9);
}

TEST(Weights, CountInWhatIsHeldOut) {
  SeparableModel model;
  model.nominal.push_back(Constant());
  SeparableTerm strong;
  strong.fill = [](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) {
    for (std::size_t i = 0; i < kSamples; ++i)
      design(static_cast<Eigen::Index>(i), 0) = IsNoisy(i) ? 1.0 : 0.0;
  };
  DescribeEach(strong, {{"size", "1", 1.0}});
  model.causes.push_back(std::move(strong));
  model.rules.push_back({.name = "loud"});
  model.measured = Noise(4);
  for (std::size_t i = 0; i < kSamples; ++i) model.measured[i] += IsNoisy(i) ? 1.0 : 0.0;
  model.block_length = 50;
  const SeparableStudy study(std::move(model));
  const Judge judge(study, Weights(), {});
  const std::vector<std::size_t> with{0};
  const ScoredModel richer = judge.Fit(with, nullptr);
  const ScoredModel poorer = judge.Fit({}, nullptr);
  ASSERT_EQ(richer.noise.order, 0);
  const std::vector<double> weights = Weights();
  const auto left = [&](const ScoredModel& scored) {
    return HeldOutResiduals(study, weights, judge.folds(false), scored.fit);
  };
  const std::vector<double> before = left(poorer);
  const std::vector<double> after = left(richer);
  double expected = 0.0;  // halved squares, in standard deviations of what each sample is known to
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double sd = richer.noise.innovation_sd * (IsNoisy(i) ? kTimes : 1.0);
    expected += 0.5 * (std::pow(before[i] / sd, 2) - std::pow(after[i] / sd, 2));
  }
  EXPECT_NEAR(judge.HeldOutGain(richer.fit, poorer.fit, richer.noise, false), expected, 1e-6 * expected);
}

// Two lines of a mesh in each of four channels, clearly beyond chance.
TEST(IsBeyondChance, ChargesWhatIsAsSharpAsItIsLargeByThat) {
  CauseRule rule{.degrees_of_freedom = 2};
  const Comparison comparison{.likelihood_ratio = 119.0,
                              .delta_bic = 119.0 - 16.0 * 11.0,
                              .samples = std::exp(11.0),
                              .p_value = 1e-17,
                              .more_parameters = 16.0};
  EXPECT_DOUBLE_EQ(DeltaBic(comparison, rule), -57.0);
  EXPECT_FALSE(IsBeyondChance(comparison, rule, 1e-15, 0.01));
  rule.known_by_size = true;
  EXPECT_NEAR(DeltaBic(comparison, rule), 119.0 - 16.0 * std::log(119.0), 1e-9);
  EXPECT_TRUE(IsBeyondChance(comparison, rule, 1e-15, 0.01));
  EXPECT_FALSE(IsBeyondChance(comparison, rule, 0.02, 0.01));
}

TEST(IsBeyondChance, AsksForTheEvidenceThatTheRuleAsksFor) {
  const Comparison weak{.likelihood_ratio = 30.0, .delta_bic = -6.0, .more_parameters = 5.0};
  EXPECT_TRUE(IsBeyondChance(weak, {.name = "line", .named = false}, 0.001, 0.004));
  EXPECT_FALSE(IsBeyondChance(weak, {.name = "bend", .least_bic = 0.0, .named = false}, 0.001, 0.004));
  EXPECT_FALSE(IsBeyondChance(weak, {.name = "line", .named = false}, 0.01, 0.004));
}

// However small its p-value: a cause that costs more than it brings is not named.
TEST(IsBeyondChance, NamesNothingWithABicBelowZero) {
  Comparison weak{.likelihood_ratio = 30.0, .delta_bic = -0.1, .more_parameters = 5.0};
  EXPECT_FALSE(IsBeyondChance(weak, {.name = "play"}, 1e-9, 0.004));
  EXPECT_FALSE(IsBeyondChance(weak, {.name = "play", .least_bic = -100.0}, 1e-9, 0.004));
  weak.delta_bic = 0.1;
  EXPECT_TRUE(IsBeyondChance(weak, {.name = "play"}, 1e-9, 0.004));
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_weights_test
