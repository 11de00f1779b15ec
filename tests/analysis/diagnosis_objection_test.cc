// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/selection.h"
#include "analysis/diagnosis/separable_study.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis {
namespace {

TEST(Objection, AsksForAnAmountAwayFromZero) {
  SeparableTerm slope;
  slope.fill = [](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) {
    design.col(0).setLinSpaced(-1.0, 1.0);
  };
  DescribeEach(slope, {{"size", "1", 1.0}});
  SeparableModel model;
  model.measured = WhiteNoise(100, 0.2, 5);
  model.causes.push_back(std::move(slope));
  model.rules.push_back({.name = "slope", .parameters = {{"size", "1", -10.0, 10.0, true}}});
  const SeparableStudy study(std::move(model));
  const Judge judge(study, std::vector<double>(100, 1.0), {});
  ModelFit fit;
  fit.usable = true;
  fit.causes = {0};
  fit.cause_parameters = {{{"size", "1", -2.9, 1.0}}};
  EXPECT_EQ(judge.Objection(fit, 0), "size = -2.9 ± 1 1 is not away from zero");
  EXPECT_EQ(judge.Objection(fit, 0, 2.0), "");
  fit.cause_parameters[0][0].value = 3.1;
  EXPECT_EQ(judge.Objection(fit, 0), "");
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis
