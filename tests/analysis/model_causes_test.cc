// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "analysis/model/plant_model.h"
#include "analysis/units.h"

namespace strainwave::analysis::model::model_causes_test {
namespace {

// The plainest gear: one slope, no friction, nothing in series.
TwistLaw OneSlope(double stiffness_Nm_per_rad) {
  TwistLaw law;
  law.spring.k1_Nm_per_rad = law.spring.k2_Nm_per_rad = law.spring.k3_Nm_per_rad = stiffness_Nm_per_rad;
  law.hysteresis.limit_Nm = 0.0;
  return law;
}

// A gear that is loaded step by step and keeps its memory.
class Loaded {
 public:
  explicit Loaded(const TwistLaw& law, double step_s = 0.0) : curve_(CurveOf(law)) {
    memory_.step_s = step_s;
  }

  double TwistAt(double torque_Nm) {
    const OutputGrip none{{0.0, 1.0}, 0.0, 0.0};
    const TwistSolution found =
        SolveDeviatingTwist(curve_, 1.0, memory_, none, 0.0, torque_Nm, memory_.twist_before_rad);
    EXPECT_NEAR(found.torque_Nm, torque_Nm, 1e-9);
    memory_.twist_before_rad = found.twist_rad;
    memory_.anchor_rad = MovedAnchor(curve_.hysteresis, found.twist_rad, memory_.anchor_rad);
    for (std::size_t i = 0; i < 2; ++i) {
      memory_.further_anchor_rad[i] =
          MovedAnchor(curve_.deviations.further_friction[i], found.twist_rad, memory_.further_anchor_rad[i]);
    }
    return found.output_rad;
  }

  // In steps of a hundredth of a newton-metre.
  double GoTo(double torque_Nm) {
    const double from_Nm = torque_Nm_;
    const int steps = static_cast<int>(std::lround(std::abs(torque_Nm - from_Nm) / 0.01));
    double output_rad = 0.0;
    for (int i = 1; i <= steps; ++i) output_rad = TwistAt(from_Nm + (torque_Nm - from_Nm) * i / steps);
    torque_Nm_ = torque_Nm;
    return output_rad;
  }

 private:
  TwistCurve curve_;
  TwistMemory memory_;
  double torque_Nm_{};
};

std::string MessageOf(std::string_view term, std::string_view parameter, double value) {
  PlantModel model = DefaultPlantModel();
  FindParameter(model, term, parameter) = value;
  try {
    CompilePlantModel(model);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(Backlash, GivesWayByItsWidthBetweenTheEndsOfTheDeadZone) {
  const Backlash backlash{3e-4, 0.05};
  EXPECT_DOUBLE_EQ(BacklashTwist_rad(backlash, 0.05) - BacklashTwist_rad(backlash, -0.05), 3e-4);
  EXPECT_DOUBLE_EQ(BacklashTwist_rad(backlash, 30.0), 1.5e-4);
  EXPECT_DOUBLE_EQ(BacklashTwist_rad(backlash, 0.025), 0.75e-4);
}

TEST(DeviatingGear, IsTheNominalOneWithoutDeviations) {
  TwistLaw law;
  law.series_compliance_rad_per_Nm = 5.8e-5;
  const TwistCurve curve = CurveOf(law);
  EXPECT_FALSE(curve.deviates);
  const OutputGrip grip{{0.5, 7e-4}, 0.5 / 7e-4, 1e-4};
  for (double torque = -40.0; torque < 40.0; torque += 1.7) {
    const TwistSolution nominal = SolveTwist(curve, 1.02, 3e-5, grip, 1e-4, torque, 0.0);
    const TwistSolution found =
        SolveDeviatingTwist(curve, 1.02, {3e-5, {}, 0.0, 0.0}, grip, 1e-4, torque, 0.0);
    EXPECT_NEAR(found.twist_rad, nominal.twist_rad, 1e-13);
    EXPECT_NEAR(found.output_rad, nominal.output_rad, 1e-13);
    const TwistSolution share = SolveTwistAtDeflection(curve, 1.02, 3e-5, 1e-4 * torque, 0.0);
    EXPECT_NEAR(
        SolveDeviatingTwistAtDeflection(curve, 1.02, {3e-5, {}, 0.0, 0.0}, 1e-4 * torque, 0.0).torque_Nm,
        share.torque_Nm, 1e-8);
  }
}

TEST(DeviatingGear, HasTheSlopeThatDifferencesGive) {
  TwistLaw law;
  law.deviations = {0.1, 2e9, {{{0.7, 2e-4}, {0.3, 9e-4}}}, 300.0, {2e-4, 0.1}, 1.0};
  const TwistCurve curve = CurveOf(law);
  ASSERT_TRUE(curve.deviates);
  const TwistMemory memory{1e-5, {-4e-5, 2e-5}, 3e-5, 0.01};
  for (double twist = -2.03e-3; twist < 2e-3; twist += 1.7e-5) {
    const auto torque = [&](double at) { return DeviatingTorque(curve, 1.0, memory, at).torque_Nm; };
    const double slope = (torque(twist + 1e-9) - torque(twist - 1e-9)) / 2e-9;
    EXPECT_NEAR(DeviatingTorque(curve, 1.0, memory, twist).stiffness_Nm_per_rad, slope, 1e-4 * slope)
        << twist;
  }
}

TEST(DeviatingGear, StepsByTheDeadZoneAsItsTorqueTurns) {
  TwistLaw law = OneSlope(2e4);
  law.series_compliance_rad_per_Nm = 1e-5;
  law.deviations.backlash = {3e-4, 0.05};
  for (const double beside : {0.0, 1.0}) {
    law.deviations.backlash_beside_friction = beside;
    Loaded gear(law);
    // Between ±0.5 Nm: 1 Nm over 2e4 Nm/rad and 1e-5 rad/Nm, and the zone.
    EXPECT_NEAR(gear.TwistAt(0.5) - gear.TwistAt(-0.5), 5e-5 + 1e-5 + 3e-4, 1e-12) << beside;
    EXPECT_NEAR(gear.TwistAt(0.0), 0.0, 1e-12);
  }
}

TEST(DeviatingGear, StepsWhereTheSpringTurnsIfThePlayIsBesideTheFriction) {
  // Falling from +10 Nm, friction of 1 Nm slips backwards: the spring's torque is zero at −1 Nm in all.
  TwistLaw law = OneSlope(2e4);
  law.hysteresis = {1.0, 5e-5};
  law.deviations.backlash = {3e-4, 0.01};
  const auto step_at = [&](double beside, double torque_Nm) {
    law.deviations.backlash_beside_friction = beside;
    Loaded gear(law);
    gear.GoTo(10.0);
    const double before_rad = gear.GoTo(torque_Nm + 0.05);
    return before_rad - gear.GoTo(torque_Nm - 0.05);
  };
  EXPECT_GT(step_at(1.0, -1.0), 2.9e-4);
  EXPECT_LT(step_at(1.0, 0.0), 0.1e-4);
  EXPECT_GT(step_at(0.0, 0.0), 2.9e-4);
  EXPECT_LT(step_at(0.0, -1.0), 0.1e-4);
}

TEST(DeviatingGear, IsStifferOnOneSide) {
  TwistLaw law = OneSlope(2e4);
  law.deviations.asymmetry_share = 0.1;
  Loaded gear(law);
  EXPECT_NEAR(gear.TwistAt(22.0), 22.0 / 2.2e4, 1e-12);
  EXPECT_NEAR(gear.TwistAt(-18.0), -18.0 / 1.8e4, 1e-12);
}

TEST(DeviatingGear, KeepsItsKneesAtTheirTorquesWhenOneSideIsStiffer) {
  TwistLaw law;
  law.hysteresis.limit_Nm = 0.0;
  law.deviations.asymmetry_share = 0.05;
  Loaded gear(law);
  const double nominal = 7.0 / 1.6e4 + 18.0 / 2.5e4 + 9.0 / 2.9e4;
  EXPECT_NEAR(gear.TwistAt(34.0), nominal / 1.05, 1e-12);
  EXPECT_NEAR(gear.TwistAt(-34.0), -nominal / 0.95, 1e-12);
}

TEST(DeviatingGear, HardensWithTheCubeOfItsTwist) {
  TwistLaw law = OneSlope(2e4);
  law.deviations.hardening_Nm_per_rad3 = 3e9;
  Loaded gear(law);
  const double twist = gear.TwistAt(40.0);
  EXPECT_NEAR(2e4 * twist + 3e9 * twist * twist * twist, 40.0, 1e-8);
  EXPECT_LT(twist, 40.0 / 2e4);
  EXPECT_NEAR(gear.TwistAt(-40.0), -twist, 1e-12);
}

TEST(DeviatingGear, WidensItsLoopByEachFurtherElement) {
  TwistLaw law = OneSlope(2e4);
  law.hysteresis = {1.0, 5e-5};
  law.deviations.further_friction = {{{0.6, 2e-4}, {0.4, 6e-4}}};
  Loaded gear(law);
  gear.GoTo(40.0);
  const double falling = gear.GoTo(0.0);
  gear.GoTo(-40.0);
  const double rising = gear.GoTo(0.0);
  // All three slip: spring torque ±2 Nm at zero in all.
  EXPECT_NEAR(falling - rising, 2.0 * 2.0 / 2e4, 1e-9);
}

TEST(DeviatingGear, LagsBehindARampByItsViscosity) {
  // c φ̇ + K φ = r t ends in φ = r t/K − c r/K².
  constexpr double kStep_s = 0.01, kRate_Nm_per_s = 2.0, kViscous = 4000.0, kStiffness = 2e4;
  TwistLaw law = OneSlope(kStiffness);
  law.deviations.viscous_Nms_per_rad = kViscous;
  Loaded gear(law, kStep_s);
  double twist = 0.0;
  for (int i = 1; i <= 1000; ++i) twist = gear.TwistAt(kRate_Nm_per_s * kStep_s * i);
  EXPECT_NEAR(twist, 20.0 / kStiffness - kViscous * kRate_Nm_per_s / (kStiffness * kStiffness), 1e-9);
}

TEST(LocalToothDamage, IsABumpOfItsHeightAndWidthOnceATurn) {
  KinematicError error;
  error.amplitude_rad = {};
  error.damage = {5e-5, RadFromDeg(350.0), RadFromDeg(6.0)};
  const KinematicSeries series = CompileKinematicError(error, 80.0);
  const auto at = [&](double output_deg) { return KinematicErrorAt(series, 80.0 * RadFromDeg(output_deg)); };
  EXPECT_NEAR(at(350.0), 5e-5, 1e-15);
  EXPECT_NEAR(at(353.0), 2.5e-5, 1e-12);
  EXPECT_NEAR(at(347.0), 2.5e-5, 1e-12);
  EXPECT_NEAR(at(350.0 + 720.0), 5e-5, 1e-15);
  EXPECT_LT(at(10.0), 1e-12);
}

TEST(LocalToothDamage, HasTheDerivativeThatDifferencesGive) {
  KinematicError error;
  error.damage = {5e-5, RadFromDeg(10.0), RadFromDeg(6.0)};
  const KinematicSeries series = CompileKinematicError(error, 80.0);
  for (double output_deg = 0.0; output_deg < 20.0; output_deg += 0.7) {
    const double input = 80.0 * RadFromDeg(output_deg);
    const double slope =
        (KinematicErrorAt(series, input + 1e-4) - KinematicErrorAt(series, input - 1e-4)) / 2e-4;
    const GearPhasors phasors = PhasorsAt(input, 1.0 / 80.0);
    EXPECT_NEAR(EvaluateDamagedKinematicError(series, phasors, HarmonicsOf(phasors)).derivative, slope,
                1e-10);
  }
}

TEST(DriveCauses, ResistAsTheirFormulasSay) {
  // 10 Nms/rad forwards and 4 backwards is 7 in the mean: what is on top is 3·|ω|.
  EXPECT_DOUBLE_EQ(AsymmetricViscous_Nm(6.0, 2.0), 6.0);
  EXPECT_DOUBLE_EQ(AsymmetricViscous_Nm(6.0, -2.0), 6.0);
  EXPECT_DOUBLE_EQ(QuadraticDrag_Nm(0.5, 3.0), 4.5);
  EXPECT_DOUBLE_EQ(QuadraticDrag_Nm(0.5, -3.0), -4.5);
  EXPECT_NEAR(PeriodicTorque_Nm({2.0, 3.0, 0.25 * kPi}, kPi / 12.0), 2.0, 1e-12);
  const TorqueWindow window{1.5, 2.0, 3.0};
  EXPECT_EQ(WindowTorque_Nm(window, 1.999), 0.0);
  EXPECT_EQ(WindowTorque_Nm(window, 2.0), 1.5);
  EXPECT_EQ(WindowTorque_Nm(window, 3.0), 0.0);
  const TorqueWindow soft{2.0, 0.0, 8.0, 0.25};  // rises and falls over 2 s each
  EXPECT_DOUBLE_EQ(WindowTorque_Nm(soft, 1.0), 1.0);
  EXPECT_DOUBLE_EQ(WindowTorque_Nm(soft, 4.0), 2.0);
  EXPECT_DOUBLE_EQ(WindowTorque_Nm(soft, 7.5), 2.0 * 0.15625);  // u = 1/4
}

TEST(OutputDrift, FollowsTemperatureAndTime) {
  EXPECT_NEAR(OutputDrift_rad({2e-6, 22.0, 0.0, 0.0}, 27.0, 100.0), 1e-5, 1e-18);
  EXPECT_NEAR(OutputDrift_rad({0.0, 22.0, 3e-7, 0.0}, 27.0, 100.0), 3e-5, 1e-18);
  // One time constant settles 1 − 1/e of the whole.
  EXPECT_NEAR(OutputDrift_rad({0.0, 22.0, 3e-7, 50.0}, 27.0, 50.0), 1.5e-5 * (1.0 - std::exp(-1.0)), 1e-18);
}

TEST(FrictionDrift, ScalesTheWholeLaw) {
  Friction friction;
  friction.drift = {-0.01, 30.0, 0.0};
  const FrictionAtTemperature at = AtTemperature(friction, 40.0);
  const FrictionAtTemperature nominal = AtTemperature({}, 40.0);
  EXPECT_NEAR(SteadyFriction_Nm(at, 100.0, 20.0), 0.9 * SteadyFriction_Nm(nominal, 100.0, 20.0), 1e-12);
  friction.drift = {0.0, 30.0, 0.5};
  EXPECT_NEAR(SteadyFriction_Nm(AtTemperature(friction, 40.0, 1800.0), 100.0, 20.0),
              1.25 * SteadyFriction_Nm(nominal, 100.0, 20.0), 1e-12);
}

TEST(ExponentialCreep, GoesOnToItsShareWithItsTimeConstant) {
  const ExponentialCreepElement element{2e-6, 30.0};
  double creep_rad = 0.0;
  for (int i = 0; i < 3000; ++i) creep_rad = AdvancedCreep_rad(element, 25.0, 0.01, creep_rad);
  EXPECT_NEAR(creep_rad, 5e-5 * (1.0 - std::exp(-1.0)), 1e-12);
}

TEST(BrakeYield, GivesWayInFourForms) {
  // Excess goes 0 → 2 → 1 → 3 Nm, in steps of half a second.
  const auto total = [](const BrakeYield& yield) {
    double sum = 0.0, before = 0.0, furthest = 0.0;
    for (const double excess : {0.0, 2.0, 1.0, 3.0}) {
      sum += BrakeYield_rad(yield, excess, before, furthest, 0.5);
      before = excess;
      furthest = std::max(furthest, excess);
    }
    return sum;
  };
  EXPECT_DOUBLE_EQ(total({0.4, 0.0, 0.0, 0.0}), 0.6);
  EXPECT_DOUBLE_EQ(total({0.0, 0.1, 0.0, 0.0}), 0.4);
  EXPECT_DOUBLE_EQ(total({0.0, 0.0, 0.1, 0.0}), 0.3);
  EXPECT_DOUBLE_EQ(total({0.0, 0.0, 0.0, 0.7}), 0.7);
}

TEST(TransducerCauses, ShowsItsZeroOffset) {
  TorqueTransducer transducer;
  const double without = TransducerReading_Nm(transducer, 12.0, 30.0);
  transducer.zero_offset_Nm = -0.4;
  EXPECT_DOUBLE_EQ(TransducerReading_Nm(transducer, 12.0, 30.0), without - 0.4);
}

// Amplitude at an order of the input angle, over whole turns of the output.
template <typename Signal>
double Line(const Signal& signal, double order) {
  constexpr int kSamples = 400000;
  std::complex<double> sum;
  for (int i = 0; i < kSamples; ++i) {
    const double angle_rad = 80.0 * kTwoPi * i / kSamples;
    sum += signal(angle_rad) * std::polar(1.0, -order * angle_rad);
  }
  return 2.0 * std::abs(sum) / kSamples;
}

TEST(VibrationCauses, HaveTheirOrdersAndSidebands) {
  const BearingDefect bearing{0.3, 10.35, 0.7, 0.5, {}};
  const auto defect = [&](double angle_rad) { return BearingLine_m_per_s2(bearing, angle_rad); };
  EXPECT_NEAR(Line(defect, 10.35), 0.3, 1e-6);
  EXPECT_NEAR(Line(defect, 12.35), 0.3 * 0.5 / 2.0, 1e-6);
  EXPECT_NEAR(Line(defect, 8.35), 0.3 * 0.5 / 2.0, 1e-6);
  const FlexsplineCrack crack{0.2, 1.1, 0.5, 0.4, {}};
  const auto cracked = [&](double angle_rad) { return Crack_m_per_s2(crack, angle_rad, 80.0); };
  // 2 (1 + 1/80) = 2.025 per input turn; sidebands an 80th off.
  EXPECT_NEAR(Line(cracked, 2.025), 0.2, 1e-6);
  EXPECT_NEAR(Line(cracked, 4.05), 0.1, 1e-6);
  EXPECT_NEAR(Line(cracked, 6.075), 0.05, 1e-6);
  EXPECT_NEAR(Line(cracked, 2.0375), 0.2 * 0.4 / 2.0, 1e-6);
}

TEST(VibrationCauses, FollowTheSpeed) {
  const Imbalance imbalance{0.1, 0.5 * kPi, RadPerSFromRpm(1000.0)};
  EXPECT_NEAR(Imbalance_m_per_s2(imbalance, 0.0, RadPerSFromRpm(3000.0)), 0.9, 1e-12);
  // At its frequency a mode of damping ζ answers with 1/(2ζ), a quarter of a turn late.
  TorsionalMode mode;
  mode.line_m_per_s2 = 0.05;
  mode.damping = 0.04;
  const double speed = kTwoPi * mode.frequency_Hz / mode.line_order;
  const auto line = [&](double angle_rad) { return ModeLine_m_per_s2(mode, angle_rad, speed); };
  EXPECT_NEAR(Line(line, 2.0), 0.05 / 0.08, 1e-6);
  EXPECT_NEAR(line(0.0), 0.0, 1e-12);
}

TEST(VibrationCauses, AddTheirMeanSquaresToTheLevel) {
  VibrationCauses causes;
  causes.imbalance = {0.1, 0.0, RadPerSFromRpm(1000.0)};
  causes.crack = {0.2, 0.0, 0.5, 0.4, {}};
  causes.bearing.amplitude_m_per_s2 = 0.3;
  const double speed = RadPerSFromRpm(2400.0);
  constexpr int kSamples = 200000;
  double shaft = 0.0, rest = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    // Eighty output turns: the defect's order comes round, too.
    const double angle_rad = 80.0 * 80.0 * kTwoPi * i / kSamples;
    shaft += std::pow(Imbalance_m_per_s2(causes.imbalance, angle_rad, speed), 2) / kSamples;
    rest += (std::pow(Crack_m_per_s2(causes.crack, angle_rad, 80.0), 2) +
             std::pow(BearingLine_m_per_s2(causes.bearing, angle_rad), 2)) /
            kSamples;
  }
  EXPECT_NEAR(SquaresAt(causes, speed, 80.0).fourth, shaft, 1e-3 * shaft);
  EXPECT_NEAR(SquaresAt(causes, speed, 80.0).second, rest, 1e-3 * rest);
}

TEST(PlantModelCauses, HasNoneOfTheCausesByDefault) {
  const PlantParameters plant = CompilePlantModel(DefaultPlantModel());
  EXPECT_FALSE(plant.deviations.any());
  EXPECT_FALSE(plant.drive_causes.any_torque());
  EXPECT_FALSE(plant.vibration_causes.any());
  EXPECT_FALSE(plant.brake.yield.any());
  EXPECT_EQ(plant.drive_causes.delay_s, 0.0);
  EXPECT_EQ(plant.kinematic.damage.height_rad, 0.0);
  EXPECT_EQ(plant.exponential_creep.compliance_rad_per_Nm, 0.0);
  EXPECT_EQ(OutputDrift_rad(plant.output_drift, 60.0, 1e6), 0.0);
  EXPECT_EQ(FrictionDriftFactor(plant.friction.drift, 60.0, 1e6), 1.0);
}

TEST(PlantModelCauses, RejectsCausesThatCannotBe) {
  EXPECT_EQ(MessageOf("gear_backlash", "width_rad", -1e-4),
            "gear_backlash.width_rad = -0.0001 must be zero or above");
  EXPECT_EQ(MessageOf("cubic_hardening", "hardening_Nm_per_rad3", -1.0),
            "cubic_hardening.hardening_Nm_per_rad3 = -1 must be zero or above");
  EXPECT_EQ(MessageOf("asymmetric_stiffness", "asymmetry_share", 1.0),
            "asymmetric_stiffness.asymmetry_share = 1 must be between -1 and 1");
  EXPECT_EQ(MessageOf("drive_time_delay", "delay_s", 0.02),
            "drive_time_delay.delay_s = 0.02 must be at most 0.016 (what the simulated bench carries)");
  EXPECT_EQ(MessageOf("local_tooth_damage", "width_rad", 0.0),
            "local_tooth_damage.width_rad = 0 must be above zero");
}

}  // namespace
}  // namespace strainwave::analysis::model::model_causes_test
