// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/separable_study.h"
#include "analysis/units.h"
#include "tests/analysis/toy_terms.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis::diagnosis_other_optima_test {
namespace {

constexpr std::size_t kSamples = 200;
constexpr double kOrder = 30.0;
constexpr double kAlias = 170.0;  // the same on so many even samples a turn

// A wave of unknown order, which is searched at two orders.
SeparableStudy Wave(double second_start, std::size_t most_starts) {
  SeparableTerm offset;
  offset.fill = [](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) { design.setOnes(); };
  DescribeEach(offset, {{"offset", "1", 1.0}});
  SeparableTerm wave;
  wave.fill = [](std::span<const double> nonlinear_parameters, Eigen::Ref<Eigen::MatrixXd> design) {
    for (Eigen::Index i = 0; i < design.rows(); ++i)
      design(i, 0) = std::cos(nonlinear_parameters[0] * kTwoPi * static_cast<double>(i) / kSamples);
  };
  wave.nonlinear_parameters = {{1.0, 199.0, 0.2}};
  wave.starts = [=](const WeightedResidual&) {
    return std::vector<std::vector<double>>{{kOrder + 0.1}, {second_start}};
  };
  wave.most_starts = most_starts;
  DescribeEach(wave, {{"amplitude", "1", 1.0}, {"order", "1", 1.0}});
  SeparableModel model;
  model.measured = WhiteNoise(kSamples, 0.2, 5);
  for (std::size_t i = 0; i < kSamples; ++i)
    model.measured[i] += std::cos(kOrder * kTwoPi * static_cast<double>(i) / kSamples);
  model.nominal.push_back(std::move(offset));
  model.causes.push_back(std::move(wave));
  model.rules.push_back({.name = "wave", .sentence = "a wave"});
  return SeparableStudy(std::move(model));
}

ParameterValue OrderOf(const SeparableStudy& study, FitPurpose purpose) {
  const std::vector<double> ones(kSamples, 1.0);
  return study.Fit(std::vector<std::size_t>{0}, ones, nullptr, purpose).cause_parameters[0][1];
}

TEST(OtherOptima, BelongIntoTheErrorsThatAreReported) {
  const SeparableStudy study = Wave(kAlias, 1);
  const ParameterValue judged = OrderOf(study, FitPurpose::kJudge);
  EXPECT_NEAR(judged.value, kOrder, 0.1);
  EXPECT_LT(judged.standard_error, 0.1);
  const ParameterValue reported = OrderOf(study, FitPurpose::kReport);
  EXPECT_EQ(reported.value, judged.value);
  EXPECT_NEAR(1.96 * reported.standard_error, kAlias - kOrder, 0.01 * kAlias);
}

TEST(OtherOptima, ThatTheRecordExcludesDoNot) {
  const SeparableStudy study = Wave(100.0, 2);
  EXPECT_NEAR(OrderOf(study, FitPurpose::kReport).standard_error,
              OrderOf(study, FitPurpose::kJudge).standard_error, 1e-3);
}

// A wave whose phase is a number that is moved only where it pays, in noise.
ModelFit FitLeaning(double lean) {
  SeparableTerm wave;
  wave.fill = [](std::span<const double> nonlinear_parameters, Eigen::Ref<Eigen::MatrixXd> design) {
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
      const double angle = kOrder * kTwoPi * static_cast<double>(i) / kSamples;
      design(i, 0) = std::cos(angle) + nonlinear_parameters[0] * std::sin(angle);
    }
  };
  wave.nonlinear_parameters = {{-3.0, 3.0, 0.1, true, Moved::kWhereItPays}};
  wave.starts = [](const WeightedResidual&) { return std::vector<std::vector<double>>{{0.0}}; };
  DescribeEach(wave, {{"amplitude", "1", 1.0}, {"lean", "1", 1.0}});
  SeparableModel model;
  model.measured = WhiteNoise(kSamples, 0.2, 5);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double angle = kOrder * kTwoPi * static_cast<double>(i) / kSamples;
    model.measured[i] += std::cos(angle) + lean * std::sin(angle);
  }
  model.nominal.push_back(TermOf({[](std::size_t) { return 1.0; }}));
  model.causes.push_back(std::move(wave));
  model.rules.push_back({.name = "wave"});
  const std::vector<double> ones(kSamples, 1.0);
  const std::vector<std::size_t> only{0};
  return SeparableStudy(std::move(model)).Fit(only, ones, nullptr, FitPurpose::kCompare);
}

TEST(NumberThatIsMovedWhereItPays, RestsUnpenalisedWhereItDoesNot) {
  const ModelFit fit = FitLeaning(0.0);
  EXPECT_EQ(fit.state.back(), 0.0);
  EXPECT_EQ(fit.free_parameters, 2);  // offset and amplitude
  EXPECT_EQ(fit.known_before, 0.0);
}

TEST(NumberThatIsMovedWhereItPays, IsMovedAndChargedWhereItDoes) {
  const ModelFit fit = FitLeaning(0.5);
  EXPECT_NEAR(fit.state.back(), 0.5, 0.1);
  EXPECT_EQ(fit.free_parameters, 3);
  EXPECT_GT(fit.charged_parameters(), 2.0);
}

// What was known of a number before bounds its error where the record says next to nothing of it.
TEST(OtherOptima, LeaveANumberThatHardlyShowsTheRangeKnownBefore) {
  SeparableTerm faint;
  faint.fill = [](std::span<const double> nonlinear_parameters, Eigen::Ref<Eigen::MatrixXd> design) {
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
      const double angle = kOrder * kTwoPi * static_cast<double>(i) / kSamples;
      design(i, 0) = std::cos(angle) + 0.001 * nonlinear_parameters[0] * std::sin(angle);
    }
  };
  faint.nonlinear_parameters = {{-3.0, 3.0, 0.1, true}};
  faint.starts = [](const WeightedResidual&) { return std::vector<std::vector<double>>{{0.0}}; };
  DescribeEach(faint, {{"amplitude", "1", 1.0}, {"faint", "1", 1.0}});
  SeparableModel model;
  model.measured = WhiteNoise(kSamples, 0.2, 5);
  for (std::size_t i = 0; i < kSamples; ++i)
    model.measured[i] += std::cos(kOrder * kTwoPi * static_cast<double>(i) / kSamples);
  SeparableTerm offset;
  offset.fill = [](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) { design.setOnes(); };
  DescribeEach(offset, {{"offset", "1", 1.0}});
  model.nominal.push_back(std::move(offset));
  model.causes.push_back(std::move(faint));
  model.rules.push_back({.name = "faint"});
  const SeparableStudy study(std::move(model));
  const ModelFit fit = study.Fit(std::vector<std::size_t>{0}, std::vector<double>(kSamples, 1.0), nullptr,
                                 FitPurpose::kReport);
  EXPECT_NEAR(fit.cause_parameters[0][1].standard_error, 6.0 / std::sqrt(12.0), 0.1);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_other_optima_test
