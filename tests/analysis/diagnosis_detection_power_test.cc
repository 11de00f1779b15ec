// SPDX-License-Identifier: Apache-2.0
// How large a cause has to be to be found, beside what theory says and beside draws whose truth is known.
#include "analysis/diagnosis/detection_power.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_f.hpp>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "analysis/diagnosis/resampled_noise.h"
#include "analysis/diagnosis/residuals.h"
#include "analysis/diagnosis/separable_study.h"
#include "analysis/units.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::diagnosis::diagnosis_detection_power_test {
namespace {

constexpr int kSamples = 400;
constexpr double kTrialsFactor = 100.0;

// Cosine and sine of an order over one turn.
SeparableTerm Line(double order, const std::string& name) {
  SeparableTerm term;
  term.columns = 2;
  term.fill = [order](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) {
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
      const double angle = kTwoPi * order * static_cast<double>(i) / kSamples;
      design(i, 0) = std::cos(angle);
      design(i, 1) = std::sin(angle);
    }
  };
  DescribeAsHarmonic(term, name + "_arcmin", "arcmin", 1.0);
  return term;
}

SeparableTerm Constant(const std::string& name) {
  SeparableTerm term;
  term.fill = [](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) { design.setOnes(); };
  DescribeEach(term, {{name, "arcmin", 1.0}});
  return term;
}

CauseRule LineRule(const std::string& name, double most = 1e3) {
  return {.name = name,
          .sentence = "a line",
          .parameters = {{name + "_arcmin", "arcmin", 0.0, most, true}},
          .degrees_of_freedom = 2,
          .trials_factor = kTrialsFactor};
}

// White noise about a constant, and one cause: a line of order 3.
SeparableModel LineInNoise(double noise, double line = 0.0) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0.0, noise);
  SeparableModel model;
  for (int i = 0; i < kSamples; ++i)
    model.measured.push_back(5.0 + line * std::cos(kTwoPi * 3 * i / kSamples) + normal(random));
  model.nominal = {Constant("offset_arcmin")};
  model.causes = {Line(3.0, "third")};
  model.rules = {LineRule("third")};
  model.unit = "arcmin";
  model.noise_floor = noise;
  model.block_length = 10;
  model.largest_noise_order = 0;
  return model;
}

DetectionPower PowerOf(const SeparableModel& model, const ParallelFor& parallel = InTurn) {
  const SeparableStudy study(model);
  DiagnoseOptions options;
  options.parallel = parallel;
  return MeasureDetectionPower(study, Diagnose(study, options), options);
}

void OnThree(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 3; ++t) {
    threads.emplace_back([&task, count, t] {
      for (std::size_t i = count; i-- > 0;)
        if (i % 3 == t) task(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

// Of an effect of two numbers beside a constant, by the noncentral F distribution at the p-value that the
// search asks for: 0.6 % of clean records may get a name, three quarters of these a cause's.
double SigmaByTheory() {
  const double freedom = kSamples - 3.0;
  const double p_value = -std::expm1(0.75 / kTrialsFactor * std::log1p(-0.006));
  const double threshold =
      boost::math::quantile(boost::math::complement(boost::math::fisher_f(2.0, freedom), p_value));
  double low = 1.0;
  double high = 20.0;
  for (int i = 0; i < 60; ++i) {
    const double sigma = 0.5 * (low + high);
    const boost::math::non_central_f distribution(2.0, freedom, sigma * sigma);
    (boost::math::cdf(boost::math::complement(distribution, threshold)) < 0.9 ? low : high) = sigma;
  }
  return low;
}

TEST(DetectionPower, IsThatOfTheNoncentralFDistribution) {
  const DetectionPower power = PowerOf(LineInNoise(0.2));
  ASSERT_EQ(power.causes.size(), 1u);
  const CausePower& line = power.causes[0];
  ASSERT_TRUE(line.sigma.has_value()) << line.objection;
  const double expected = SigmaByTheory();
  EXPECT_NEAR(line.sigma->value, expected, 0.1 * expected);
  EXPECT_LT(line.sigma->low, expected);
  EXPECT_GT(line.sigma->high, expected);
  // An amplitude A has a norm of A √(n/2).
  EXPECT_EQ(line.amount, "third_arcmin");
  EXPECT_EQ(line.unit, "arcmin");
  EXPECT_NEAR(line.size->value, expected * 0.2 / std::sqrt(0.5 * kSamples), 0.12 * line.size->value);
  for (const PlantedOutcome& trial : line.trials) EXPECT_TRUE(trial.others.empty());
  EXPECT_EQ(power.without.size(), 20u);
  EXPECT_EQ(power.without_with_others(), 0u);
  EXPECT_EQ(power.searches, line.trials.size() + power.without.size());
}

TEST(DetectionPower, AsksForFourTimesTheSizeInFourTimesTheNoise) {
  const DetectionPower quiet = PowerOf(LineInNoise(0.05));
  const DetectionPower loud = PowerOf(LineInNoise(0.2));
  EXPECT_NEAR(loud.causes[0].size->value / quiet.causes[0].size->value, 4.0, 0.1);
}

TEST(DetectionPower, IsTheSameOnAnyNumberOfThreads) {
  const DetectionPower alone = PowerOf(LineInNoise(0.2));
  const DetectionPower together = PowerOf(LineInNoise(0.2), OnThree);
  ASSERT_EQ(alone.causes[0].trials.size(), together.causes[0].trials.size());
  EXPECT_EQ(alone.causes[0].size->value, together.causes[0].size->value);
  for (std::size_t i = 0; i < alone.causes[0].trials.size(); ++i) {
    EXPECT_EQ(alone.causes[0].trials[i].amount, together.causes[0].trials[i].amount);
    EXPECT_EQ(alone.causes[0].trials[i].sigma, together.causes[0].trials[i].sigma);
    EXPECT_EQ(alone.causes[0].trials[i].found, together.causes[0].trials[i].found);
  }
}

TEST(DetectionPower, TakesACauseOutOfTheRecordsBeforeItIsPlanted) {
  const double without = PowerOf(LineInNoise(0.2)).causes[0].size->value;
  const double with = PowerOf(LineInNoise(0.2, 3.0)).causes[0].size->value;
  EXPECT_NEAR(with / without, 1.0, 0.1);
}

TEST(DetectionPower, SaysWhatIsNeverFoundAndWhy) {
  SeparableModel model = LineInNoise(0.2);
  model.causes.push_back(Constant("shift_arcmin"));
  model.rules.push_back(
      {.name = "shift", .sentence = "", .parameters = {{"shift_arcmin", "arcmin", -9.0, 9.0, true}}});
  // A quarter of what would be found is the most that it may be.
  model.causes.push_back(Line(9.0, "small"));
  model.rules.push_back(LineRule("small", 0.25 * SigmaByTheory() * 0.2 / std::sqrt(0.5 * kSamples)));
  const DetectionPower power = PowerOf(model);
  ASSERT_EQ(power.causes.size(), 3u);
  EXPECT_TRUE(power.causes[0].size.has_value());
  EXPECT_FALSE(power.causes[1].size.has_value());
  EXPECT_EQ(power.causes[1].objection, "the nominal model takes all that it adds");
  EXPECT_FALSE(power.causes[2].size.has_value());
  EXPECT_EQ(power.causes[2].found(), 0u);
  EXPECT_LT(power.causes[2].trials.size(), 28u) << "it is soon clear";
  for (const PlantedOutcome& trial : power.causes[2].trials)
    EXPECT_LE(trial.amount, 1.0001 * model.rules[2].parameters[0].high);
}

TEST(DetectionPower, IsNotMeasuredWhereNothingCanBeTold) {
  SeparableModel model = LineInNoise(0.2);
  for (double& value : model.measured) value = 5.0;
  const SeparableStudy study(model);
  Diagnosis diagnosis;
  diagnosis.weights.assign(kSamples, 1.0);
  diagnosis.nominal = diagnosis.extended = study.Fit({}, diagnosis.weights, nullptr, FitPurpose::kReport);
  diagnosis.extended.predicted.setConstant(5.0);
  EXPECT_EQ(MeasureDetectionPower(study, diagnosis, {}).refusal,
            "the records have no noise: what is too small to be found cannot be told");
}

TEST(SeparableStudy, RefusesAResponseOfAnotherLength) {
  const SeparableStudy study(LineInNoise(0.2));
  EXPECT_EQ(MessageOf([&] { study.WithResponse(std::vector<double>(3)); }),
            "a response of 3 samples for records of 400 (expected as many)");
}

TEST(NamesOnly, AreThoseOfTheWholeDiagnosis) {
  const SeparableStudy study(LineInNoise(0.2, 0.3));
  DiagnoseOptions options;
  const Diagnosis whole = Diagnose(study, options);
  options.names_only = true;
  const Diagnosis names = Diagnose(study, options);
  ASSERT_EQ(whole.causes.size(), 1u);
  ASSERT_EQ(names.causes.size(), 1u);
  EXPECT_EQ(names.causes[0].index, whole.causes[0].index);
  EXPECT_EQ(names.causes[0].evidence.delta_bic, whole.causes[0].evidence.delta_bic);
}

// A first-order autoregression in two segments, the second one with half the weight.
TEST(ResampledNoise, IsLikeTheResidualItComesFrom) {
  constexpr double kCoefficient = 0.6;
  constexpr int kMany = 4000;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0.0, 0.5);
  SeparableModel model = LineInNoise(0.2);
  model.measured.clear();
  double value = 0.0;
  for (int i = 0; i < kMany; ++i) {
    value = kCoefficient * value + normal(random);
    model.measured.push_back(i < kMany / 2 ? value : std::sqrt(2.0) * value);
  }
  model.segments = {0, kMany / 2};
  model.largest_noise_order = 2;
  const SeparableStudy study(model);
  std::vector<double> weights(kMany, 1.0);
  std::fill(weights.begin() + kMany / 2, weights.end(), 0.5);
  weights[100] = 0.0;
  ModelFit fit;
  fit.predicted = Eigen::VectorXd::Zero(kMany);
  const ResampledNoise noise(study, fit, weights);
  EXPECT_NEAR(noise.innovation_sd(), 0.5, 0.02);
  const std::vector<double> drawn = noise.Draw(11);
  EXPECT_EQ(noise.Draw(11), drawn);
  EXPECT_NE(noise.Draw(12), drawn);
  const auto moment = [&](int first, int last, int lag) {
    double sum = 0.0;
    for (int i = first + lag; i < last; ++i)
      sum += drawn[static_cast<std::size_t>(i)] * drawn[static_cast<std::size_t>(i - lag)];
    return sum / (last - first);
  };
  const double variance = 0.25 / (1.0 - kCoefficient * kCoefficient);
  EXPECT_NEAR(moment(0, kMany / 2, 0), variance, 0.15 * variance);
  EXPECT_NEAR(moment(kMany / 2, kMany, 0), 2.0 * variance, 0.3 * variance);
  EXPECT_NEAR(moment(0, kMany / 2, 1) / moment(0, kMany / 2, 0), kCoefficient, 0.06);
  // A constant, whitened, is 1 − c of itself.
  const double sigma = noise.MatchedFilterSigma(std::vector<double>(kMany, 1.0));
  const double expected = (1.0 - kCoefficient) / 0.5 * std::sqrt(kMany * (0.5 + 0.25));
  EXPECT_NEAR(sigma, expected, 0.1 * expected);
}

// Found with probability Φ((x − x90)/w + 1.2816), sizes as the procedure chooses them.
TEST(DetectableSize, IsWithinItsIntervalAndWithoutBias) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int inside = 0;
  double bias = 0.0;
  double square = 0.0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    const double truth = -1.0 + 2.0 * uniform(random);
    const double width = run % 2 == 0 ? 0.17 : 0.5;
    std::vector<PlantedTrial> trials;
    for (int round = 0; round < 6; ++round) {
      for (const double x : NextLnSizes(trials, 0.0, 3.7, 4)) {
        const double z = (x - truth) / width + 1.2816;
        trials.push_back({x, uniform(random) < 0.5 * std::erfc(-z / std::sqrt(2.0))});
      }
    }
    const DetectableSize size = EstimateDetectableSize(trials);
    ASSERT_TRUE(size.reached);
    inside += size.ln_low <= truth && truth <= size.ln_high ? 1 : 0;
    bias += (size.ln_size - truth) / kRuns;
    square += (size.ln_size - truth) * (size.ln_size - truth) / kRuns;
  }
  ::testing::Test::RecordProperty("inside", inside);
  EXPECT_GE(inside, 180) << "of 200, 95 % expected";
  EXPECT_NEAR(bias, 0.0, 0.1);
  EXPECT_LT(std::sqrt(square), 0.35);
}

TEST(DetectableSize, HasNoBoundWhereNothingWasFound) {
  const std::vector<PlantedTrial> missed{{0.0, false}, {1.0, false}, {2.0, false}, {2.0, false}};
  EXPECT_FALSE(EstimateDetectableSize(missed).reached);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_detection_power_test
