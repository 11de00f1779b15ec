// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/weibayes.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/reliability/test_plan.h"

namespace strainwave::analysis::reliability::weibayes_test {
namespace {

// Of n units without a failure R at their time is at least (1 − C)^(1/n): by hand, without χ².
TEST(Weibayes, OfNoFailureIsTheRuleOfSuccesses) {
  const std::vector<Lifetime> lives(5, Lifetime::Suspended(1750));
  const Weibayes fit = FitWeibayes(lives, 2.0, 0.1, 0.9);
  EXPECT_FALSE(fit.scale.has_value());
  EXPECT_FALSE(fit.quantile.has_value());
  EXPECT_TRUE(std::isinf(fit.quantile_bounds.high));
  const double survival = std::exp(-std::pow(1750 / fit.scale_bounds.low, 2.0));
  EXPECT_NEAR(survival, std::pow(0.05, 0.2), 1e-12);
  EXPECT_NEAR(std::exp(-std::pow(fit.quantile_bounds.low / fit.scale_bounds.low, 2.0)), 0.9, 1e-12);
}

// χ² of 4 and 2 degrees of freedom at 95 % and 5 %, as tables print them: 9.488 and 0.1026.
TEST(Weibayes, OfOneFailureHasTheChiSquaredOfTables) {
  const std::vector<Lifetime> lives{Lifetime::Failed(100), Lifetime::Suspended(150), Lifetime::Suspended(200),
                                    Lifetime::Suspended(250), Lifetime::Suspended(300)};
  const Weibayes fit = FitWeibayes(lives, 1.0, 0.1, 0.9);
  EXPECT_NEAR(*fit.scale, 1000.0, 1e-9);
  EXPECT_NEAR(fit.scale_bounds.low, 2000.0 / 9.488, 0.01);
  EXPECT_NEAR(fit.scale_bounds.high, 2000.0 / 0.1026, 10.0);
}

TEST(Weibayes, TellsWhatOtherShapesSay) {
  const std::vector<Lifetime> lives(3, Lifetime::Suspended(1e9));
  const std::vector<Weibayes> fits = WeibayesSensitivity(lives, 2.0, 0.1, 0.9);
  ASSERT_EQ(fits.size(), 5U);
  EXPECT_EQ(fits.front().shape, 1.0);
  EXPECT_EQ(fits.back().shape, 4.0);
  for (std::size_t i = 1; i < fits.size(); ++i)
    EXPECT_GT(fits[i].quantile_bounds.low, fits[i - 1].quantile_bounds.low);
}

// Five times the life at B50: docs/sources.md#hd-csf-csg, 7000 h and 35 000 h.
TEST(Weibayes, TakesAShapeFromTwoQuantiles) {
  const double shape = ShapeOfQuantiles(0.1, 7000, 0.5, 35000);
  EXPECT_NEAR(std::pow(5.0, shape), std::log(0.5) / std::log(0.9), 1e-12);
  EXPECT_THROW(ShapeOfQuantiles(0.5, 7000, 0.1, 35000), std::invalid_argument);
  EXPECT_THROW(ShapeOfQuantiles(0.1, 7000, 0.5, 700), std::invalid_argument);
}

TEST(Weibayes, RejectsUnitsOfWhichNothingIsKnownToHaveRun) {
  try {
    FitWeibayes(std::vector<Lifetime>{Lifetime::FailedBefore(10)}, 2.0, 0.1, 0.9);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "lifetimes has no unit that is known to have run");
  }
}

}  // namespace
}  // namespace strainwave::analysis::reliability::weibayes_test
