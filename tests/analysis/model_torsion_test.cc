// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/model/plant_parameters.h"
#include "analysis/units.h"

namespace strainwave::analysis::model::model_torsion_test {
namespace {

// The loop of the lock test, walked in small steps of torque; returns the twists at zero torque on the way
// down and on the way up.
struct Crossings {
  double falling_rad, rising_rad;
};
Crossings WalkLoop(const TwistCurve& curve, double peak_Nm) {
  Crossings crossings{};
  const OutputGrip none{{0.0, 1.0}, 0.0, 0.0};
  double anchor = 0.0;
  double twist = 0.0;
  const auto go = [&](double from_Nm, double to_Nm) {
    constexpr int kSteps = 3400;
    double at_zero = 0.0;
    for (int i = 1; i <= kSteps; ++i) {
      const double torque = from_Nm + (to_Nm - from_Nm) * i / kSteps;
      const TwistSolution solution = SolveTwist(curve, 1.0, anchor, none, 0.0, torque, twist);
      twist = solution.twist_rad;
      anchor = MovedAnchor(curve.hysteresis, twist, anchor);
      if (std::abs(torque) < 1e-9) at_zero = twist;
    }
    return at_zero;
  };
  go(0.0, peak_Nm);
  crossings.falling_rad = go(peak_Nm, -peak_Nm);
  crossings.rising_rad = go(-peak_Nm, peak_Nm);
  return crossings;
}

TEST(TorsionSpring, WindsUpByFiveArcminAtRatedTorque) {
  // docs/effects.md E5: 7/1.6e4 + 18/2.5e4 + 9/2.9e4 = 1.4678e-3 rad.
  EXPECT_NEAR(SpringTwist({}, 34.0), 1.4678e-3, 1e-7);
  EXPECT_NEAR(ArcminFromRad(SpringTwist({}, 34.0)), 5.05, 0.01);
}

TEST(TorsionSpring, GivesBackTheTorqueThatTwistedIt) {
  const SpringCurve curve = CurveOf(TorsionSpring{});
  for (double torque = -50.0; torque <= 50.0; torque += 0.37) {
    EXPECT_NEAR(EvaluateSpring(curve, SpringTwist(curve.spring, torque)).torque_Nm, torque, 1e-11);
  }
}

TEST(TorsionSpring, HasTheSlopesOfItsSegments) {
  const SpringCurve curve = CurveOf(TorsionSpring{});
  for (const auto& [torque, slope] : {std::pair{3.0, 1.6e4}, {-15.0, 2.5e4}, {30.0, 2.9e4}}) {
    EXPECT_EQ(EvaluateSpring(curve, SpringTwist(curve.spring, torque)).stiffness_Nm_per_rad, slope);
  }
}

TEST(Hysteresis, IsOneArcminWideAtZeroTorque) {
  // docs/effects.md E6: "about 1′".
  const TwistLaw law;
  const Crossings crossings = WalkLoop(CurveOf(law), 34.0);
  const double width = crossings.falling_rad - crossings.rising_rad;
  EXPECT_NEAR(ArcminFromRad(width), 1.0, 0.02);
  EXPECT_NEAR(width, HysteresisWidth_rad(law.spring, law.hysteresis), 1e-9);
}

TEST(Hysteresis, VanishesWithoutFriction) {
  TwistLaw law;
  law.hysteresis.limit_Nm = 0.0;
  const Crossings crossings = WalkLoop(CurveOf(law), 34.0);
  EXPECT_NEAR(crossings.falling_rad, crossings.rising_rad, 1e-12);
}

TEST(SolveTwist, BalancesTheTorquesFromAnyStart) {
  const TwistLaw law{{}, {2.33, 8e-5}, 5.8e-5};
  const TwistCurve curve = CurveOf(law);
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double anchor = 2e-3 * unit(engine);
    const double load = 60.0 * unit(engine);
    const OutputGrip grip{{5.0, 1e-3}, 5.0 / 1e-3, 3e-3 * unit(engine)};
    const double scale = 1.0 + 0.05 * unit(engine);
    const TwistSolution found = SolveTwist(curve, scale, anchor, grip, 1e-4, load, 5e-3 * unit(engine));
    // The balance, from the parts and not through the solver.
    const double spring = EvaluateSpring(CurveOf(law.spring), scale * found.twist_rad).torque_Nm;
    const double gear = spring + ElementTorque(law.hysteresis, found.twist_rad, anchor);
    const double output = 1e-4 + found.twist_rad + 5.8e-5 * gear;
    EXPECT_NEAR(gear + ElementTorque(grip.element, output, grip.anchor_rad), load, 1e-6);
    EXPECT_NEAR(found.output_rad, output, 1e-12);
  }
}

TEST(SolveTwist, AtADeflectionSharesItWithTheSeriesCompliance) {
  const TwistCurve curve = CurveOf(TwistLaw{{}, {2.33, 8e-5}, 5.8e-5});
  for (const double deflection : {-3e-3, -1e-4, 0.0, 5e-4, 3e-3}) {
    const TwistSolution found = SolveTwistAtDeflection(curve, 1.0, 0.0, deflection, 0.0);
    EXPECT_NEAR(found.twist_rad + 5.8e-5 * found.torque_Nm, deflection, 1e-12);
  }
}

TEST(SeriesCompliance, MakesK3AppearMuchSofter) {
  // docs/effects.md E17: with 4e4 and 3e4 Nm/rad in series, 2.9e4 appears as 1.1e4.
  const SeriesCompliance series;
  EXPECT_NEAR(1.0 / (1.0 / 2.9e4 + series.total_rad_per_Nm()), 1.1e4, 300.0);
}

TEST(TorsionalResonance, LiesWhereTheCatalogueOfEffectsSaysItDoes) {
  // docs/effects.md E15: 95 Hz with 0.05 kg·m² at the output, 41 Hz with 0.5.
  Inertia inertia;
  inertia.output_kgm2 = 0.05;
  EXPECT_NEAR(TorsionalResonance_Hz(1.6e4, inertia, 80.0), 95.0, 0.5);
  inertia.output_kgm2 = 0.5;
  EXPECT_NEAR(TorsionalResonance_Hz(1.6e4, inertia, 80.0), 41.0, 0.5);
}

TEST(Creep, GoesOnByItsShareEveryDecadeOfTime) {
  const Creep creep;
  CreepState state{};
  const CreepStep step = MakeCreepStep(creep, 0.01);
  std::vector<double> at_decades;
  double next_s = 4.0;
  for (int i = 1; i <= 400000; ++i) {
    AdvanceCreep(step, 34.0, state);
    if (0.01 * i >= next_s) {
      at_decades.push_back(CreepTwist_rad(state));
      next_s *= 10.0;
    }
  }
  const double wind_up = 34.0 / creep.reference_Nm_per_rad;
  ASSERT_EQ(at_decades.size(), 4u);
  EXPECT_NEAR((at_decades[2] - at_decades[0]) / wind_up / 2.0, creep.share_per_decade,
              0.2 * creep.share_per_decade);
}

TEST(Creep, LowersTheSlopeOfARampByLessThanATenthOfAPercent) {
  for (const double rate_Nm_per_s : {1.0, 2.0}) {
    CreepState state{};
    const CreepStep step = MakeCreepStep({}, 0.01);
    double torque = 0.0;
    while (torque < 34.0) AdvanceCreep(step, torque += 0.01 * rate_Nm_per_s, state);
    EXPECT_GT(CreepTwist_rad(state), 0.0);
    EXPECT_LT(CreepTwist_rad(state), 0.001 * SpringTwist({}, 34.0));
  }
}

TEST(KinematicError, IsAboutOneArcminPeakToPeak) {
  // docs/effects.md E1: 1′ at most, and the tooth engagement of E2 with tenths of it beside.
  const KinematicSeries series = CompileKinematicError({}, 80.0);
  double lowest = 0.0;
  double highest = 0.0;
  for (int i = 0; i < 80 * 90; ++i) {
    const double error = KinematicErrorAt(series, kTwoPi * i / 90.0);
    lowest = std::min(lowest, error);
    highest = std::max(highest, error);
  }
  EXPECT_NEAR(ArcminFromRad(highest - lowest), 1.0, 0.15);
}

TEST(KinematicError, IsTheSumOfItsSines) {
  const KinematicError error;
  const KinematicSeries series = CompileKinematicError(error, 80.0);
  // Orders per output turn: 80, 160, 320, the 162 teeth of the circular spline, 1, 2.
  constexpr double kOrders[] = {80.0, 160.0, 320.0, 162.0, 1.0, 2.0};
  for (double output = 0.0; output < 7.0; output += 0.0137) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 6; ++k)
      sum += error.amplitude_rad[k] * std::sin(kOrders[k] * output + error.phase_rad[k]);
    EXPECT_NEAR(KinematicErrorAt(series, 80.0 * output), sum, 1e-15);
  }
}

TEST(KinematicError, HasTheDerivativeThatDifferencesGive) {
  const KinematicSeries series = CompileKinematicError({}, 80.0);
  for (double input = 0.0; input < 500.0; input += 1.7) {
    constexpr double kStep = 1e-4;
    const double slope =
        (KinematicErrorAt(series, input + kStep) - KinematicErrorAt(series, input - kStep)) / (2.0 * kStep);
    const GearPhasors phasors = PhasorsAt(input, 1.0 / 80.0);
    EXPECT_NEAR(EvaluateKinematicError(series, phasors, HarmonicsOf(phasors)).derivative, slope, 1e-10);
  }
}

}  // namespace
}  // namespace strainwave::analysis::model::model_torsion_test
