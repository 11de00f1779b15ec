// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/competing_modes.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::analysis::reliability::competing_modes_test {
namespace {

std::vector<ModeLifetime> TwoModes() {
  return {{Lifetime::Failed(100), 0},     {Lifetime::Failed(400), 0},  {Lifetime::Failed(900), 0},
          {Lifetime::Failed(1200), 1},    {Lifetime::Failed(1300), 1}, {Lifetime::Failed(1500), 1},
          {Lifetime::Suspended(1600), -1}};
}

// survreg of R on each mode, the other's failures suspended.
TEST(CompetingModes, AreEachThatOfSurvreg) {
  const CompetingModes fit = FitCompetingModes(TwoModes(), 2, {"fracture", "wear"});
  EXPECT_NEAR(fit.modes[0].shape, 0.80694, 1e-4);
  EXPECT_NEAR(fit.modes[0].scale, 2754.1, 0.1);
  EXPECT_NEAR(fit.modes[1].shape, 7.9051, 1e-3);
  EXPECT_NEAR(fit.modes[1].scale, 1510.9, 0.1);
}

TEST(CompetingModes, LetASystemSurviveWhatAllOfThemDo) {
  const CompetingModes fit = FitCompetingModes(TwoModes(), 2, {"fracture", "wear"});
  for (const double share : {1e-6, 0.1, 0.5, 0.9}) {
    const double time = SystemQuantile(fit, share);
    const double survival = WeibullSurvival(fit.modes[0].shape, fit.modes[0].scale, time) *
                            WeibullSurvival(fit.modes[1].shape, fit.modes[1].scale, time);
    EXPECT_NEAR(survival, 1.0 - share, 1e-9);
  }
}

// A second mode that comes long after B10 of the first leaves its bounds as they are.
TEST(CompetingModes, HaveTheBoundsOfTheOneThatDecides) {
  std::vector<ModeLifetime> lives = TwoModes();
  const std::vector<Lifetime> first = LivesOfMode(lives, 0);
  const BoundedEstimate alone =
      BoundsOfQuantile(FitWeibull(first), first, 0.01, {.level = 0.9, .most_failures_to_correct = 0.0});
  const BoundedEstimate system =
      BoundsOfSystemQuantile(FitCompetingModes(lives, 2, {"fracture", "wear"}), lives, 0.01, 0.9);
  EXPECT_NEAR(system.value / alone.value, 1.0, 1e-6);
  EXPECT_NEAR(system.likelihood_ratio.low / alone.likelihood_ratio.low, 1.0, 0.01);
  EXPECT_NEAR(system.fisher.high / alone.fisher.high, 1.0, 0.01);
  EXPECT_GT(system.likelihood_ratio.low, 0.0);
}

TEST(CompetingModes, NameTheModeThatHasNoLaw) {
  std::vector<ModeLifetime> lives = TwoModes();
  lives[6] = {Lifetime::Failed(1600), 2};
  try {
    FitCompetingModes(lives, 3, {"fracture", "wear", "grease"});
    FAIL();
  } catch (const NoEstimate& error) {
    EXPECT_STREQ(error.what(),
                 "mode grease: the only failure lies at one time, 1600, which no other unit outlived: the "
                 "likelihood grows with the shape without end");
  }
}

}  // namespace
}  // namespace strainwave::analysis::reliability::competing_modes_test
