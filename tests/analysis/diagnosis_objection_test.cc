// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/selection.h"
#include "analysis/diagnosis/separable_study.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis::diagnosis_objection_test {
namespace {

// A study of one straight line; what its fit found is up to the test.
SeparableStudy LineStudy(std::vector<ParameterRule> parameters) {
  SeparableTerm slope;
  slope.fill = [](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) {
    design.col(0).setLinSpaced(-1.0, 1.0);
  };
  DescribeEach(slope, {{"size", "1", 1.0}});
  SeparableModel model;
  model.measured = WhiteNoise(100, 0.2, 5);
  model.causes.push_back(std::move(slope));
  model.rules.push_back({.name = "slope", .parameters = std::move(parameters)});
  return SeparableStudy(std::move(model));
}

ModelFit Found(const ParameterValue& parameter) {
  ModelFit fit;
  fit.usable = true;
  fit.causes = {0};
  fit.cause_parameters = {{parameter}};
  return fit;
}

TEST(Objection, AsksForAnAmountAwayFromZero) {
  const SeparableStudy study = LineStudy({{"size", "1", -10.0, 10.0, true}});
  const Judge judge(study, std::vector<double>(100, 1.0), {});
  EXPECT_EQ(judge.Objection(Found({"size", "1", -2.9, 1.0}), 0), "size = -2.9 ± 1 1 is not away from zero");
  EXPECT_EQ(judge.Objection(Found({"size", "1", -2.9, 1.0}), 0, 2.0), "");
  EXPECT_EQ(judge.Objection(Found({"size", "1", 3.1, 1.0}), 0), "");
}

// A fit that ends where the range ends has no better place within it; of what may be anywhere in the range
// that says nothing.
TEST(Objection, AsksForANumberInItsRangeUnlessTheRecordLeavesItOpen) {
  const SeparableStudy study = LineStudy({{"speed", "rad/s", 1.0, 9.0, false}});
  const Judge judge(study, std::vector<double>(100, 1.0), {});
  EXPECT_EQ(judge.Objection(Found({"speed", "rad/s", 9.1, 3.9}), 0), "speed = 9.1 rad/s is outside 1 to 9");
  EXPECT_EQ(judge.Objection(Found({"speed", "rad/s", 9.1, 4.1}), 0), "");
  EXPECT_EQ(judge.Objection(Found({"speed", "rad/s", 8.9, 0.1}), 0), "");
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_objection_test
