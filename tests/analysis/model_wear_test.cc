// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "analysis/model/plant_parameters.h"

namespace strainwave::analysis::model::model_wear_test {
namespace {

constexpr double kLifeTest_h = 1750.0;
constexpr double kTurnsPerHour = 2400.0 * 60.0;

// The life test of docs/sources.md#shivam-2023 in steps of `step_h`.
WearState LifeTest(const WearRates& rates, double hours, double torque_Nm, double temperature_degC,
                   double step_h) {
  WearState state;
  const int steps = static_cast<int>(std::lround(hours / step_h));
  for (int i = 0; i < steps; ++i) {
    const double turns = kTurnsPerHour * step_h;
    AdvanceWear(rates, {turns, std::pow(torque_Nm, 3.0) * turns, temperature_degC}, state);
  }
  return state;
}

TEST(Wear, NeverFalls) {
  WearState before;
  for (int i = 0; i < 500; ++i) {
    WearState after = before;
    const double turns = kTurnsPerHour * 3.5;
    AdvanceWear({}, {turns, std::pow(40.0, 3.0) * turns, 30.0 + i % 40}, after);
    EXPECT_GT(after.run_in, before.run_in - 1e-15);
    EXPECT_GT(after.tooth, before.tooth);
    EXPECT_GT(after.flexspline, before.flexspline);
    EXPECT_GT(after.grease, before.grease);
    before = after;
  }
}

TEST(Wear, StandsStillAtStandstill) {
  WearState state{0.2, 0.3, 0.4, 0.5};
  AdvanceWear({}, {0.0, 0.0, 80.0}, state);
  EXPECT_EQ(state.run_in, 0.2);
  EXPECT_EQ(state.tooth, 0.3);
  EXPECT_EQ(state.flexspline, 0.4);
  EXPECT_EQ(state.grease, 0.5);
}

TEST(Wear, DependsLittleOnTheStepsThatItIsCountedIn) {
  const WearState fine = LifeTest({}, 400.0, 40.0, 45.0, 0.1);
  const WearState coarse = LifeTest({}, 400.0, 40.0, 45.0, 1.0);
  EXPECT_NEAR(coarse.tooth, fine.tooth, 0.01 * fine.tooth);
  EXPECT_NEAR(coarse.flexspline, fine.flexspline, 0.01 * fine.flexspline);
  EXPECT_NEAR(coarse.grease, fine.grease, 1e-9);
}

TEST(Wear, IsABathtubForTheTeeth) {
  const double first = LifeTest({}, 50.0, 40.0, 45.0, 1.0).tooth;
  const double middle =
      LifeTest({}, 650.0, 40.0, 45.0, 1.0).tooth - LifeTest({}, 600.0, 40.0, 45.0, 1.0).tooth;
  const double last =
      LifeTest({}, 1750.0, 40.0, 45.0, 1.0).tooth - LifeTest({}, 1700.0, 40.0, 45.0, 1.0).tooth;
  EXPECT_GT(first, 2.0 * middle);
  EXPECT_GT(last, 1.2 * middle);
}

TEST(Wear, CountsLoadWithItsCube) {
  WearRates rates;
  rates.flexspline_growth = 0.0;
  const double half = LifeTest(rates, 100.0, 20.0, 45.0, 1.0).flexspline;
  const double full = LifeTest(rates, 100.0, 40.0, 45.0, 1.0).flexspline;
  EXPECT_NEAR(full / half, 8.0, 1e-9);
}

TEST(Wear, TakesAboutATenthOfK2OverTheLifeTestOfAnySpecimen) {
  double least = 1.0;
  double most = 0.0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const PlantParameters specimen = DrawSpecimen({}, seed);
    const WearState worn = LifeTest(specimen.wear, kLifeTest_h, 40.8, 46.0, 1.0);
    const WearFactors factors = FactorsOf(specimen.wear_effects, worn);
    least = std::min(least, 1.0 - factors.k2);
    most = std::max(most, 1.0 - factors.k2);
    EXPECT_GT(factors.kinematic[1], 1.15);
    EXPECT_LT(factors.kinematic[1], 2.0);
    EXPECT_LT(factors.k1, 1.0);
    EXPECT_LT(factors.k3, 1.0);
  }
  EXPECT_GT(least, 0.06);
  EXPECT_LT(most, 0.18);
  EXPECT_GT(most - least, 0.02);  // specimens differ
}

TEST(Wear, LooksDifferentAtTheSameStiffnessAfterAnotherLife) {
  // Heavy and cold wears the flexspline, light and hot the teeth: where both have lost 4 % of K2, the
  // transmission error has grown by different amounts, so that one cannot be read off the other.
  const auto kinematic_at_loss = [](double torque_Nm, double temperature_degC) {
    WearState state;
    WearFactors factors;
    while (factors.k2 > 0.96) {
      const double turns = kTurnsPerHour * 5.0;
      AdvanceWear({}, {turns, std::pow(torque_Nm, 3.0) * turns, temperature_degC}, state);
      factors = FactorsOf({}, state);
    }
    return factors.kinematic[3] - 1.0;
  };
  EXPECT_GT(kinematic_at_loss(25.0, 75.0), 1.5 * kinematic_at_loss(45.0, 30.0));
}

TEST(Specimen, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const PlantParameters a = DrawSpecimen({}, 5);
  const PlantParameters b = DrawSpecimen({}, 5);
  EXPECT_EQ(a.spring.k2_Nm_per_rad, b.spring.k2_Nm_per_rad);
  EXPECT_EQ(a.vibration.order_gain, b.vibration.order_gain);
  std::set<double> stiffnesses;
  for (unsigned seed = 0; seed < 50; ++seed) stiffnesses.insert(DrawSpecimen({}, seed).spring.k2_Nm_per_rad);
  EXPECT_EQ(stiffnesses.size(), 50u);
}

TEST(Specimen, IsTheNominalOneWithoutScatter) {
  PlantParameters nominal;
  nominal.scatter = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  nominal.transducer.gain_error_sd = 0.0;
  const PlantParameters drawn = DrawSpecimen(nominal, 9);
  EXPECT_EQ(drawn.spring.k1_Nm_per_rad, nominal.spring.k1_Nm_per_rad);
  EXPECT_EQ(drawn.kinematic.phase_rad, nominal.kinematic.phase_rad);
  EXPECT_EQ(drawn.friction.coulomb_Nm, nominal.friction.coulomb_Nm);
  EXPECT_EQ(drawn.vibration.mode_gain, nominal.vibration.mode_gain);
  EXPECT_EQ(drawn.transducer.gain_error, 0.0);
}

}  // namespace
}  // namespace strainwave::analysis::model::model_wear_test
