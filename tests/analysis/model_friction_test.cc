// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "analysis/model/friction.h"
#include "analysis/model/thermal.h"
#include "analysis/units.h"

namespace strainwave::analysis::model::model_friction_test {
namespace {

double Efficiency(double torque_Nm, double speed_rpm, double temperature_degC) {
  const double ideal_Nm = torque_Nm / 80.0;
  const FrictionAtTemperature friction = AtTemperature({}, temperature_degC);
  return ideal_Nm / (ideal_Nm + SteadyFriction_Nm(friction, RadPerSFromRpm(speed_rpm), torque_Nm));
}

TEST(Friction, GivesTheMakersEfficiencies) {
  // docs/effects.md E8: 78 % at 34 Nm and 72.5 % at 19.6 Nm, 1000 rpm, 20 °C.
  EXPECT_NEAR(Efficiency(34.0, 1000.0, 20.0), 0.78, 0.005);
  EXPECT_NEAR(Efficiency(19.6, 1000.0, 20.0), 0.725, 0.005);
}

TEST(Friction, LeavesSeventyToEightyPercentAtRatedLoadAndSpeed) {
  const double efficiency = Efficiency(34.0, 2000.0, 25.0);
  EXPECT_GT(efficiency, 0.70);
  EXPECT_LT(efficiency, 0.80);
}

TEST(Friction, TakesFiveAndAHalfNewtonCentimetresAtNoLoad) {
  // docs/effects.md E8: 5.6 Ncm at 1000 rpm and 20 °C, to the digits given there.
  EXPECT_NEAR(SteadyFriction_Nm(AtTemperature({}, 20.0), RadPerSFromRpm(1000.0), 0.0), 0.056, 0.001);
}

TEST(Friction, FallsByADecadeInItsViscousPartFromColdToWarm) {
  // docs/effects.md E10: "about a decade from −10 to 40 °C".
  EXPECT_NEAR(ViscousCoefficient({}, -10.0) / ViscousCoefficient({}, 40.0), 10.0, 1.0);
}

TEST(Friction, DipsAfterBreakaway) {
  const FrictionAtTemperature friction = AtTemperature({}, 40.0);
  const double start = SteadyFriction_Nm(friction, 0.1, 0.0);
  const double dip = SteadyFriction_Nm(friction, 30.0, 0.0);
  const double fast = SteadyFriction_Nm(friction, 500.0, 0.0);
  EXPECT_LT(dip, start);
  EXPECT_LT(dip, fast);
}

TEST(Friction, OpposesEitherDirectionAlike) {
  const FrictionAtTemperature friction = AtTemperature({}, 20.0);
  EXPECT_EQ(SteadyFriction_Nm(friction, -50.0, 10.0), -SteadyFriction_Nm(friction, 50.0, -10.0));
}

TEST(Friction, LosesHalfOfItToTheFlexsplineAtFullLoad) {
  // docs/effects.md E11: 20 % of the loss at no load, 50 % at full load.
  Friction without;
  without.flexspline_Nm = without.flexspline_load_coefficient = 0.0;
  const double speed = RadPerSFromRpm(1000.0);
  const auto share = [&](double torque_Nm) {
    return 1.0 - SteadyFriction_Nm(AtTemperature(without, 20.0), speed, torque_Nm) /
                     SteadyFriction_Nm(AtTemperature({}, 20.0), speed, torque_Nm);
  };
  EXPECT_NEAR(share(0.0), 0.2, 0.01);
  EXPECT_NEAR(share(34.0), 0.5, 0.01);
}

TEST(Thermal, SettlesWhereTheResistancesSay) {
  const Thermal thermal;
  ThermalState state;
  for (int second = 0; second < 8 * 3600; ++second) AdvanceThermal(thermal, {35.0, 10.0}, 22.0, 1.0, state);
  const double error_K = 28.0 * std::exp(-8.0);  // eight hours, of time constants of an hour at most
  EXPECT_NEAR(state.gear_degC, 22.0 + 35.0 * (0.35 + 0.45), error_K);
  EXPECT_NEAR(state.housing_degC, 22.0 + 35.0 * 0.45, error_K);
  EXPECT_NEAR(state.motor_degC, 22.0 + 10.0 * 1.6, error_K);
}

TEST(Thermal, TakesTwentyToSixtyMinutes) {
  // docs/effects.md E10: time constant of the gear.
  const Thermal thermal;
  ThermalState state;
  const double end_degC = 22.0 + 35.0 * 0.8;
  double minutes = 0.0;
  while (end_degC - state.gear_degC > (end_degC - 22.0) * std::exp(-1.0)) {
    AdvanceThermal(thermal, {35.0, 0.0}, 22.0, 1.0, state);
    minutes += 1.0 / 60.0;
  }
  EXPECT_GT(minutes, 20.0);
  EXPECT_LT(minutes, 60.0);
}

TEST(Ambient, SwingsOnceADay) {
  const Ambient ambient;
  EXPECT_NEAR(AmbientTemperature_degC(ambient, 15.0 * 3600.0), 23.5, 1e-12);
  EXPECT_NEAR(AmbientTemperature_degC(ambient, 3.0 * 3600.0), 20.5, 1e-12);
}

}  // namespace
}  // namespace strainwave::analysis::model::model_friction_test
