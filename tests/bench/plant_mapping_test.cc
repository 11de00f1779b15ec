// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/bench/mapping_helpers.h"

namespace strainwave::bench::plant_mapping_test {
namespace {

double Error_rad(const GearPlant& plant) { return plant.state().input_rad / 80.0 - plant.state().output_rad; }

// The input to an angle, gently: the output's inertia stays below its drag.
void MoveTo(GearPlant& plant, double target_rad, double load_Nm = 0.0) {
  constexpr int kSteps = 60;
  const double from_rad = plant.state().input_rad;
  const int segments = 1 + static_cast<int>(std::abs(target_rad - from_rad) / 3.0);
  for (int i = 1; i <= kSteps * segments; ++i) {
    const double share = 0.5 * (1.0 - std::cos(kPi * i / (kSteps * segments)));
    Hold(plant, Driven(Input::kPosition, from_rad + share * (target_rad - from_rad), load_Nm), 0.01);
  }
  Hold(plant, Driven(Input::kPosition, target_rad, load_Nm), 0.3);
}

struct Sweep {
  std::vector<double> input_rad, error_rad;
};
// A turn of the output in standstills, starting from beyond the first.
Sweep SweepOf(GearPlant& plant, double direction, int steps) {
  Sweep sweep;
  const double start_rad = direction > 0.0 ? 0.0 : 80.0 * kTwoPi;
  MoveTo(plant, start_rad - 3.0 * direction);
  for (int i = 0; i < steps; ++i) {
    MoveTo(plant, start_rad + direction * 80.0 * kTwoPi * i / steps);
    sweep.input_rad.push_back(plant.state().input_rad);
    sweep.error_rad.push_back(Error_rad(plant));
  }
  return sweep;
}

double MeanOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// a of a·cos(order·θ − phase), by projection over the whole turn.
std::complex<double> CosineLine(const Sweep& sweep, double order_per_output_turn) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < sweep.error_rad.size(); ++i) {
    sum += sweep.error_rad[i] * std::polar(1.0, order_per_output_turn * sweep.input_rad[i] / 80.0);
  }
  return 2.0 * sum / static_cast<double>(sweep.error_rad.size());
}

const std::vector<ParameterValue> kErrorNominal = Values(
    {{"offset_arcmin", 0.3}, {"second_harmonic_amplitude_arcmin", 0.4}, {"second_harmonic_phase_deg", 70.0}});

TEST(PlantMapping, ShowsEachLineOfATransmissionErrorWithItsAmplitudeAndPhase) {
  const std::vector<NamedCause> causes{
      Cause("wave_generator_first_harmonic", {{"amplitude_arcmin", 0.11}, {"phase_deg", -40.0}}),
      Cause("wave_generator_fourth_harmonic", {{"amplitude_arcmin", 0.07}, {"phase_deg", 200.0}}),
      Cause("tooth_engagement", {{"amplitude_arcmin", 0.13}, {"phase_deg", 15.0}}),
      Cause("output_eccentricity", {{"amplitude_arcmin", 0.25}, {"phase_deg", 100.0}}),
      Cause("circular_spline_ovality", {{"amplitude_arcmin", 0.09}, {"phase_deg", -120.0}})};
  const PlantMapping mapping = PlantTermsOf(StudyKind::kTransmissionError, kErrorNominal, causes);
  EXPECT_TRUE(mapping.not_run.empty());
  GearPlant plant = PlantOf(mapping);
  const Sweep sweep = SweepOf(plant, 1.0, 800);
  struct Expected {
    double order, amplitude_arcmin, phase_deg;
  };
  for (const Expected& line : {Expected{160.0, 0.4, 70.0},
                               {80.0, 0.11, -40.0},
                               {320.0, 0.07, 200.0},
                               {162.0, 0.13, 15.0},
                               {1.0, 0.25, 100.0},
                               {2.0, 0.09, -120.0}}) {
    const std::complex<double> found = CosineLine(sweep, line.order);
    EXPECT_NEAR(ArcminFromRad(std::abs(found)), line.amplitude_arcmin, 0.003) << line.order;
    EXPECT_NEAR(std::remainder(std::arg(found) - RadFromDeg(line.phase_deg), kTwoPi), 0.0, 0.03)
        << line.order;
  }
  // And no other: of the encoders, of the coupling.
  for (const double order : {3.0, 5.0, 8.0, 13.0})
    EXPECT_LT(ArcminFromRad(std::abs(CosineLine(sweep, order))), 0.002);
}

TEST(PlantMapping, ShowsTheDifferenceBetweenTheDirections) {
  const PlantMapping mapping = PlantTermsOf(StudyKind::kTransmissionError, kErrorNominal,
                                            std::vector{Cause("backlash", {{"backlash_arcmin", 1.2}})});
  GearPlant plant = PlantOf(mapping);
  const double cw = MeanOf(SweepOf(plant, 1.0, 360).error_rad);
  const double ccw = MeanOf(SweepOf(plant, -1.0, 360).error_rad);
  EXPECT_NEAR(ArcminFromRad(cw - ccw), 1.2, 0.02);
}

TEST(PlantMapping, LeavesTheDirectionsToTheBenchWhereItsDragMakesMore) {
  const PlantMapping mapping = PlantTermsOf(StudyKind::kTransmissionError, kErrorNominal,
                                            std::vector{Cause("backlash", {{"backlash_arcmin", 0.1}})});
  ASSERT_EQ(mapping.not_run.size(), 1U);
  EXPECT_EQ(
      mapping.not_run[0],
      "backlash: the bench's own drag makes 0.28 arcmin between the directions, the model 0.10; the bench "
      "runs its own");
}

TEST(PlantMapping, ShowsADamagedTooth) {
  GearPlant damaged = PlantOf(PlantTermsOf(
      StudyKind::kTransmissionError, kErrorNominal,
      std::vector{
          Cause("local_tooth_damage",
                {{"height_arcmin", -0.5}, {"centre_deg", 200.0}, {"width_deg", 6.0}, {"skew_share", 0.5}})}));
  GearPlant whole = PlantOf(PlantTermsOf(StudyKind::kTransmissionError, kErrorNominal, {}));
  const Sweep with = SweepOf(damaged, 1.0, 720);
  const Sweep without = SweepOf(whole, 1.0, 720);
  const auto bump_at = [&](std::size_t half_degree) {
    return ArcminFromRad(with.error_rad[half_degree] - without.error_rad[half_degree]);
  };
  EXPECT_NEAR(bump_at(400), -0.5, 0.003);
  EXPECT_NEAR(bump_at(409), -0.25, 0.003);
  EXPECT_NEAR(bump_at(397), -0.25, 0.003);
  EXPECT_NEAR(bump_at(200), 0.0, 0.003);
}

TEST(PlantMapping, WindsUpWithTheLoad) {
  for (const double windup : {-0.4, -0.1}) {  // arcmin/Nm; the smaller is stiffer than the bench's couplings
    GearPlant plant =
        PlantOf(PlantTermsOf(StudyKind::kTransmissionError, kErrorNominal,
                             std::vector{Cause("load_windup", {{"windup_arcmin_per_Nm", windup}})}));
    Hold(plant, Driven(Input::kPosition, 0.0, 5.0), 3.0);
    const double error = Error_rad(plant);
    const double torque_Nm = plant.state().gear_torque_Nm;
    Hold(plant, Driven(Input::kPosition, 0.0, 25.0), 3.0);
    EXPECT_NEAR(ArcminFromRad(Error_rad(plant) - error) / (plant.state().gear_torque_Nm - torque_Nm), windup,
                0.01 * std::abs(windup));
  }
}

TEST(PlantMapping, TurnsTheDriftOfAnErrorIntoThatOfTheOutput) {
  const PlantMapping by_temperature = PlantTermsOf(
      StudyKind::kTransmissionError, kErrorNominal,
      std::vector{Cause("thermal_drift", {{"drift_arcmin_per_K", 0.2}})}, {.temperature_degC = 25.0});
  const model::OutputDrift drift = PlantOf(by_temperature).specimen().output_drift;
  EXPECT_NEAR(ArcminFromRad(model::OutputDrift_rad(drift, 30.0, 0.0)), -1.0, 1e-9);
  // 2 arcmin/h in the mean over half an hour that settles with a constant of ten minutes.
  const PlantMapping by_time = PlantTermsOf(
      StudyKind::kTransmissionError, kErrorNominal,
      std::vector{Cause("thermal_drift", {{"drift_arcmin_per_h", 2.0}, {"time_constant_s", 600.0}})},
      {.duration_s = 1800.0});
  const model::OutputDrift settling = PlantOf(by_time).specimen().output_drift;
  EXPECT_NEAR(ArcminFromRad(model::OutputDrift_rad(settling, 22.0, 1800.0)), -1.0, 1e-9);
  EXPECT_NEAR(ArcminFromRad(model::OutputDrift_rad(settling, 22.0, 600.0)),
              -(1.0 - std::exp(-1.0)) / (1.0 - std::exp(-3.0)), 1e-9);
  // 0.5 arcmin that has its crest after a sixth of an hour.
  const PlantMapping swinging = PlantTermsOf(
      StudyKind::kTransmissionError, kErrorNominal,
      std::vector{
          Cause("thermal_drift", {{"drift_swing_arcmin", 0.5}, {"phase_deg", 60.0}, {"period_s", 3600.0}})},
      {.duration_s = 3600.0});
  const model::OutputDrift swing = PlantOf(swinging).specimen().output_drift;
  EXPECT_NEAR(ArcminFromRad(model::OutputDrift_rad(swing, 22.0, 600.0)), -0.25, 1e-9);
  EXPECT_NEAR(ArcminFromRad(model::OutputDrift_rad(swing, 22.0, 2400.0)), 0.75, 1e-9);
}

const std::vector<ParameterValue> kLoopNominal = Values({{"k1_Nm_per_rad", 1.1e4},
                                                         {"k2_Nm_per_rad", 1.6e4},
                                                         {"k3_Nm_per_rad", 2.0e4},
                                                         {"friction_torque_Nm", 1.5},
                                                         {"yield_twist_arcmin", 0.4},
                                                         {"offset_arcmin", 2.0}});

// Output angle once a torque has been reached along a loop, input locked.
double AfterRamp(GearPlant& plant, double from_Nm, double to_Nm, double rate_Nm_per_s = 10.0) {
  const int steps = static_cast<int>(std::lround(std::abs(to_Nm - from_Nm) / rate_Nm_per_s / 0.01));
  for (int i = 1; i <= steps; ++i) plant.Step(Locked(from_Nm + (to_Nm - from_Nm) * i / steps), 0.01);
  Hold(plant, Locked(to_Nm), 0.1);
  return plant.state().output_rad;
}

GearPlant LoopPlant(std::vector<NamedCause> causes, const MappingContext& context = {}) {
  const PlantMapping mapping = PlantTermsOf(StudyKind::kHysteresis, kLoopNominal, causes, context);
  EXPECT_TRUE(mapping.not_run.empty());
  return PlantOf(mapping, {"load_unbalance", "load_motor_ripple", "output_drag", "kinematic_input_1",
                           "kinematic_input_2", "kinematic_input_4", "kinematic_tooth_engagement"});
}

TEST(PlantMapping, GivesTheWholeLoopTheFittedStiffness) {
  GearPlant plant = LoopPlant({}, {.t1_Nm = 8.0, .t2_Nm = 20.0});
  AfterRamp(plant, 0.0, 34.0);
  const double falling = AfterRamp(plant, 34.0, 0.0);
  AfterRamp(plant, 0.0, -34.0);
  const double rising = AfterRamp(plant, -34.0, 0.0);
  EXPECT_NEAR(falling - rising, 2.0 * 1.5 / 1.1e4, 1e-8);
  const auto slope = [&](double from_Nm, double to_Nm) {
    const double from_rad = AfterRamp(plant, from_Nm - 4.0, from_Nm);
    return (to_Nm - from_Nm) / (AfterRamp(plant, from_Nm, to_Nm) - from_rad);
  };
  AfterRamp(plant, 0.0, 5.0);
  // The spring carries 1.5 Nm less than the whole while the friction slips.
  EXPECT_NEAR(slope(7.0, 9.0), 1.1e4, 1.0);
  EXPECT_NEAR(slope(14.0, 20.0), 1.6e4, 1.0);
  EXPECT_NEAR(slope(26.0, 32.0), 2.0e4, 1.0);
}

TEST(PlantMapping, GivesALoopItsDeadZoneAndItsSides) {
  GearPlant nominal = LoopPlant({});
  GearPlant loose = LoopPlant({Cause(
      "backlash", {{"backlash_arcmin", 0.9}, {"dead_zone_torque_Nm", 0.1}, {"beside_friction", 0.0}})});
  const auto between = [](GearPlant& plant) {
    AfterRamp(plant, 0.0, 20.0);
    const double above = AfterRamp(plant, 20.0, 0.2);
    return above - AfterRamp(plant, 0.2, -0.2);
  };
  EXPECT_NEAR(ArcminFromRad(between(loose) - between(nominal)), 0.9, 1e-4);
  GearPlant beside = LoopPlant({Cause("backlash", {{"backlash_arcmin", 0.9}, {"beside_friction", 1.0}})});
  EXPECT_LT(ArcminFromRad(between(beside)), 0.2);
  GearPlant lopsided = LoopPlant({Cause("asymmetric_stiffness", {{"asymmetry_share", -0.1}})});
  EXPECT_EQ(lopsided.law().deviations.asymmetry_share, -0.1);
  GearPlant hard = LoopPlant({Cause("cubic_hardening", {{"hardening_Nm_per_rad3", 5e9}})});
  EXPECT_EQ(hard.law().deviations.hardening_Nm_per_rad3, 5e9);
}

TEST(PlantMapping, GivesALoopItsFurtherFriction) {
  GearPlant plant = LoopPlant({Cause("distributed_friction", {{"second_friction_torque_Nm", 0.6},
                                                              {"second_yield_twist_arcmin", 1.0},
                                                              {"second_start_share", 0.2},
                                                              {"third_friction_torque_Nm", 0.4},
                                                              {"third_yield_twist_arcmin", 2.0}})});
  AfterRamp(plant, 0.0, 34.0);
  const double falling = AfterRamp(plant, 34.0, 0.0);
  AfterRamp(plant, 0.0, -34.0);
  const double width = falling - AfterRamp(plant, -34.0, 0.0);
  EXPECT_NEAR(width, 2.0 * 2.5 / 1.1e4, 1e-8);
  EXPECT_EQ(LoopPlant({Cause("rate_dependence", {{"viscous_Nms_per_rad", 500.0}})})
                .law()
                .deviations.viscous_Nms_per_rad,
            500.0);
}

// A lag over the mean stiffness, and friction's rise at the usual rate, as the damper that holds back as
// much.
TEST(PlantMapping, TakesWhatTheRateDoesForADamper) {
  const auto viscous = [](const NamedCause& cause) {
    return LoopPlant({cause}).law().deviations.viscous_Nms_per_rad;
  };
  const double stiffness = 25.0 / model::SpringTwist({1.1e4, 1.6e4, 2.0e4, 7.0, 25.0}, 25.0);
  EXPECT_NEAR(viscous(Cause("rate_dependence", {{"lag_rad_s_per_Nm", 1e-6}})), 1e-6 * stiffness * stiffness,
              1e-9 * stiffness);
  const double usual =
      viscous(Cause("rate_dependence", {{"friction_rise_share", 0.2}, {"usual_rate_Nm_per_s", 1.5}}));
  EXPECT_GT(usual, 0.0);
  const double faster =
      viscous(Cause("rate_dependence", {{"friction_rise_share", 0.2}, {"usual_rate_Nm_per_s", 3.0}}));
  EXPECT_NEAR(faster, 0.5 * usual, 1e-9 * usual);
  // In proportion to the rate it rises by the share at the usual one, by the logarithm's law by ln 2 of it.
  const double straight =
      viscous(Cause("rate_dependence", {{"linear_friction_rise_share", 0.2}, {"usual_rate_Nm_per_s", 1.5}}));
  EXPECT_NEAR(straight, usual / std::log(2.0), 1e-9 * usual);
  EXPECT_NEAR(viscous(Cause("rate_dependence", {{"torque_lag_s", 0.1}})), 0.1 * stiffness, 1e-9 * stiffness);
}

TEST(PlantMapping, TakesAnAsymmetryOfTheWholeLawForOneOfItsSegments) {
  const PlantMapping mapping =
      PlantTermsOf(StudyKind::kHysteresis, {},
                   std::vector{Cause("asymmetric_stiffness", {{"law_asymmetry_share", 0.1}})}, {});
  EXPECT_TRUE(mapping.not_run.empty());
  EXPECT_EQ(LoopPlant({Cause("asymmetric_stiffness", {{"law_asymmetry_share", 0.1}})})
                .law()
                .deviations.asymmetry_share,
            LoopPlant({Cause("asymmetric_stiffness", {{"asymmetry_share", 0.1}})})
                .law()
                .deviations.asymmetry_share);
}

TEST(PlantMapping, SaysThatTheBenchIsStifferOneWayInAllSegmentsOnly) {
  const PlantMapping mapping =
      PlantTermsOf(StudyKind::kHysteresis, {},
                   std::vector{Cause("asymmetric_stiffness", {{"k1_asymmetry_share", 0.1}})}, {});
  ASSERT_EQ(mapping.not_run.size(), 1U);
  EXPECT_EQ(mapping.not_run[0], "asymmetric_stiffness: the simulated bench has no term for it");
}

TEST(PlantMapping, CreepsAsTheModelDoes) {
  // Of the twist that 20 Nm make: by share · log₁₀(1 + t/t₀), or exponentially.
  const double wind_up_rad = 20.0 * model::SpringTwist({1.1e4, 1.6e4, 2.0e4, 7.0, 25.0}, 25.0) / 25.0;
  GearPlant logarithmic =
      LoopPlant({Cause("creep", {{"creep_share_per_decade", 0.02}, {"time_constant_s", 5.0}})});
  Hold(logarithmic, Locked(20.0), 0.1);
  const double start = logarithmic.state().output_rad;
  for (const double until_s : {50.0, 500.0}) {
    Hold(logarithmic, Locked(20.0), until_s - (until_s > 100.0 ? 50.0 : 0.0));
    const double expected = 0.02 * wind_up_rad * std::log10(1.0 + until_s / 5.0);
    EXPECT_NEAR(logarithmic.state().output_rad - start, expected, 0.15 * expected);
  }
  GearPlant exponential = LoopPlant({Cause("creep", {{"creep_share", 0.03}, {"time_constant_s", 40.0}})});
  Hold(exponential, Locked(20.0), 0.1);
  const double from = exponential.state().output_rad;
  Hold(exponential, Locked(20.0), 40.0);
  EXPECT_NEAR(exponential.state().output_rad - from, 0.03 * wind_up_rad * (1.0 - std::exp(-1.0)),
              0.02 * 0.03 * wind_up_rad);
  // With the torque the plant creeps as it was found to, without a stiffness in between.
  GearPlant of_torque =
      LoopPlant({Cause("creep", {{"creep_arcmin_per_Nm", 0.002}, {"time_constant_s", 40.0}})});
  Hold(of_torque, Locked(20.0), 0.1);
  const double without = of_torque.state().output_rad;
  Hold(of_torque, Locked(20.0), 40.0);
  const double all_rad = RadFromArcmin(0.002 * 20.0);
  EXPECT_NEAR(of_torque.state().output_rad - without, all_rad * (1.0 - std::exp(-1.0)), 0.02 * all_rad);
}

TEST(PlantMapping, CreepsOverABandAsTheModelDoes) {
  GearPlant plant = LoopPlant(
      {Cause("creep",
             {{"creep_arcmin_per_Nm", 0.002}, {"time_constant_s", 2.0}, {"longest_time_constant_s", 30.0}})});
  Hold(plant, Locked(20.0), 0.1);
  const double start_rad = plant.state().output_rad;
  double until_s = 0.0;
  for (const double hold_s : {5.0, 15.0, 180.0}) {
    Hold(plant, Locked(20.0), hold_s);
    until_s += hold_s;
    // The mean of 1 − e^(−t/τ) over ln τ, by a sum of its own.
    double share = 0.0;
    constexpr int kParts = 200;
    for (int k = 0; k < kParts; ++k)
      share -= std::expm1(-until_s / (2.0 * std::pow(15.0, (k + 0.5) / kParts))) / kParts;
    EXPECT_NEAR(plant.state().output_rad - start_rad, RadFromArcmin(0.002 * 20.0) * share,
                0.04 * RadFromArcmin(0.002 * 20.0))
        << until_s;
  }
}

TEST(PlantMapping, CreepsAsOneElementWhereTheBandHasNoWidth) {
  GearPlant plant = LoopPlant(
      {Cause("creep",
             {{"creep_arcmin_per_Nm", 0.002}, {"time_constant_s", 2.0}, {"longest_time_constant_s", 2.0}})});
  Hold(plant, Locked(20.0), 0.1);
  const double start_rad = plant.state().output_rad;
  Hold(plant, Locked(20.0), 4.0);
  const double all_rad = RadFromArcmin(0.002 * 20.0);
  EXPECT_NEAR(plant.state().output_rad - start_rad, -std::expm1(-2.0) * all_rad, 0.04 * all_rad);
}

TEST(PlantMapping, SlipsAtTheBrakeByWhatTheOutputShows) {
  // Held up to 20 Nm, loaded to 30 Nm for two seconds: arcmin at the output.
  const auto slip_arcmin = [](const char* form, double value) {
    GearPlant plant = LoopPlant({Cause("brake_slip", {{form, value}, {"slip_torque_Nm", 20.0}})});
    Hold(plant, Locked(0.0), 0.5);
    const double before = plant.state().output_rad;
    Hold(plant, Locked(30.0), 2.0);
    // Less what a gear winds up by itself.
    GearPlant held = LoopPlant({});
    Hold(held, Locked(0.0), 0.5);
    const double own = held.state().output_rad;
    Hold(held, Locked(30.0), 2.0);
    return ArcminFromRad(plant.state().output_rad - before - (held.state().output_rad - own));
  };
  EXPECT_NEAR(slip_arcmin("slip_arcmin_per_Nms", 0.05), 0.05 * 10.0 * 2.0, 0.02);
  EXPECT_NEAR(slip_arcmin("slip_arcmin_per_s", 0.3), 0.3 * 2.0, 0.01);
  EXPECT_NEAR(slip_arcmin("slip_each_time_arcmin_per_Nm", 0.08), 0.8, 0.002);
  EXPECT_NEAR(slip_arcmin("slip_arcmin_per_Nm", 0.08), 0.8, 0.002);
  EXPECT_NEAR(slip_arcmin("slip_arcmin", 1.5), 1.5, 0.002);
}

TEST(PlantMapping, DriftsAndShiftsALoop) {
  const model::PlantParameters plant =
      LoopPlant({Cause("thermal_drift", {{"drift_arcmin", 0.6}, {"time_constant_s", 90.0}}),
                 Cause("torque_zero_offset", {{"offset_Nm", -0.8}})})
          .specimen();
  EXPECT_NEAR(ArcminFromRad(model::OutputDrift_rad(plant.output_drift, 22.0, 90.0)),
              0.6 * (1.0 - std::exp(-1.0)), 1e-9);
  EXPECT_EQ(plant.transducer.zero_offset_Nm, -0.8);
  const model::PlantParameters by_min =
      LoopPlant({Cause("thermal_drift", {{"drift_arcmin_per_min", 0.3}})}).specimen();
  EXPECT_NEAR(ArcminFromRad(model::OutputDrift_rad(by_min.output_drift, 22.0, 120.0)), 0.6, 1e-9);
}

}  // namespace
}  // namespace strainwave::bench::plant_mapping_test
