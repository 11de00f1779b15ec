// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/bench/mapping_helpers.h"

namespace strainwave::bench::plant_mapping_motion_test {
namespace {

const std::vector<ParameterValue> kNominal = Values(
    {{"inertia_kgm2", 3e-4}, {"viscous_Nms_per_rad", 8e-4}, {"coulomb_Nm", 0.02}, {"offset_Nm", 0.015}});

GearPlant AxisOf(std::vector<NamedCause> causes, const MappingContext& context = {}) {
  const PlantMapping mapping = PlantTermsOf(StudyKind::kMotion, kNominal, causes, context);
  EXPECT_TRUE(mapping.not_run.empty()) << mapping.not_run[0];
  return PlantOf(mapping);
}

// Mean motor torque at a steady speed over a turn of the output, quasi-static.
double TorqueAt(GearPlant& plant, double speed_rad_per_s, double load_Nm = 0.0) {
  const PlantCommands commands = Driven(Input::kSpeed, speed_rad_per_s, load_Nm);
  Hold(plant, commands, 3.0);
  const double step_s = kTwoPi / std::abs(speed_rad_per_s) / 7.0;
  double sum = 0.0;
  for (int i = 0; i < 7 * 80; ++i) {
    plant.Step(commands, step_s);
    sum += plant.state().motor_torque_Nm;
  }
  return sum / (7 * 80);
}

TEST(MotionMapping, NeedsTheTorqueOfTheFittedFriction) {
  GearPlant plant = AxisOf({});
  for (const double speed : {8.0, 80.0, -80.0}) {
    const double expected = std::copysign(0.02, speed) + 8e-4 * speed + 0.015;
    EXPECT_NEAR(TorqueAt(plant, speed), expected, 1e-6) << speed;
  }
}

TEST(MotionMapping, AcceleratesTheFittedInertia) {
  GearPlant plant = AxisOf({});
  Hold(plant, Driven(Input::kTorque, 0.0), 0.1, 0.001);
  Hold(plant, Driven(Input::kTorque, 0.5), 0.02, 0.001);
  const double from = plant.state().input_speed_rad_per_s;
  Hold(plant, Driven(Input::kTorque, 0.5), 0.05, 0.001);
  const double gained = plant.state().input_speed_rad_per_s - from;
  const double mean_speed = from + 0.5 * gained;
  EXPECT_NEAR((0.5 - 0.02 - 0.015 - 8e-4 * mean_speed) / (gained / 0.05), 3e-4, 0.03 * 3e-4);
}

TEST(MotionMapping, FrictionFollowsSpeedLoadAndDirection) {
  GearPlant plain = AxisOf({});
  GearPlant stribeck =
      AxisOf({Cause("stribeck_friction", {{"stribeck_Nm", 0.03}, {"stribeck_speed_rad_per_s", 20.0}})});
  EXPECT_NEAR(TorqueAt(stribeck, 20.0) - TorqueAt(plain, 20.0), 0.03 * std::exp(-1.0), 1e-5);
  GearPlant uneven = AxisOf({Cause("asymmetric_friction", {{"viscous_difference_Nms_per_rad", 2e-4}})});
  EXPECT_NEAR(TorqueAt(uneven, -50.0) - TorqueAt(plain, -50.0), 1e-4 * 50.0, 1e-5);
  GearPlant drag = AxisOf({Cause("quadratic_drag", {{"drag_Nms2_per_rad2", 4e-6}})});
  EXPECT_NEAR(TorqueAt(drag, -50.0) - TorqueAt(plain, -50.0), -4e-6 * 2500.0, 1e-5);
  // 16 Nm at the output are 0.2 Nm at the input.
  GearPlant loaded = AxisOf({Cause("load_dependent_friction", {{"load_coefficient", 0.15}})});
  EXPECT_NEAR(TorqueAt(loaded, 50.0, -16.0) - TorqueAt(plain, 50.0, -16.0), 0.15 * 0.2, 1e-4);
  GearPlant warm =
      AxisOf({Cause("thermal_friction_drift", {{"drift_per_K", 0.03}})}, {.temperature_degC = 12.0});
  EXPECT_NEAR(TorqueAt(warm, 50.0) - TorqueAt(plain, 50.0), 0.3 * (0.02 + 8e-4 * 50.0), 2e-4);
}

TEST(MotionMapping, FeelsPositionAsTheModelDoes) {
  GearPlant plain = AxisOf({});
  GearPlant rippled = AxisOf({Cause("position_periodic_torque",
                                    {{"amplitude_Nm", 0.02}, {"phase_deg", 50.0}, {"order_per_turn", 12.0}}),
                              Cause("gravity_load", {{"amplitude_Nm", 0.03}, {"phase_deg", -70.0}})});
  std::complex<double> ripple, weight;
  constexpr int kStepsPerTurn = 100, kTurns = 80;
  const PlantCommands commands = Driven(Input::kSpeed, 4.0);
  Hold(plain, commands, 1.0);
  Hold(rippled, commands, 1.0);
  for (int i = 0; i < kStepsPerTurn * kTurns; ++i) {
    plain.Step(commands, kTwoPi / 4.0 / kStepsPerTurn);
    rippled.Step(commands, kTwoPi / 4.0 / kStepsPerTurn);
    const double extra = rippled.state().motor_torque_Nm - plain.state().motor_torque_Nm;
    ripple += 2.0 / (kStepsPerTurn * kTurns) * extra * std::polar(1.0, 12.0 * rippled.state().input_rad);
    weight += 2.0 / (kStepsPerTurn * kTurns) * extra * std::polar(1.0, rippled.state().input_rad);
  }
  EXPECT_NEAR(std::abs(ripple), 0.02, 1e-4);
  EXPECT_NEAR(DegFromRad(std::arg(ripple)), 50.0, 0.5);
  EXPECT_NEAR(std::abs(weight), 0.03, 1e-4);
  EXPECT_NEAR(DegFromRad(std::arg(weight)), -70.0, 0.5);
}

TEST(MotionMapping, SwingsWithItsSecondInertia) {
  const PlantMapping mapping =
      PlantTermsOf(StudyKind::kMotion, kNominal,
                   std::vector{Cause("torsional_resonance", {{"frequency_Hz", 30.0},
                                                             {"damping_ratio", 0.05},
                                                             {"inertia_share", 0.4},
                                                             {"second_inertia_kgm2", 1.2e-4}})});
  GearPlant plant = PlantOf(mapping, {"load_torque_lag", "brake_compliance"});
  EXPECT_NEAR(plant.specimen().inertia.input_kgm2, 1.8e-4, 1e-12);
  EXPECT_NEAR(plant.specimen().inertia.output_kgm2, 1.2e-4 * 6400.0, 1e-9);
  // The near side held: the output rings about its rest.
  Hold(plant, Locked(0.0), 0.5, 0.001);
  const double rest_rad = plant.state().output_rad;
  Hold(plant, Locked(10.0), 0.02, 0.001);
  std::vector<double> crossings_s, crests;
  double before = plant.state().output_rad - rest_rad;
  double crest = 0.0;
  constexpr double kStep_s = 0.0001;
  for (int i = 0; i < 4000; ++i) {
    plant.Step(Locked(0.0), kStep_s);
    const double now = plant.state().output_rad - rest_rad;
    crest = std::max(crest, now);
    if (before < 0.0 && now >= 0.0) {
      crossings_s.push_back(kStep_s * (i + before / (before - now)));
      crests.push_back(crest);
      crest = 0.0;
    }
    before = now;
  }
  ASSERT_GT(crossings_s.size(), 5U);
  const double period_s = (crossings_s.back() - crossings_s[1]) / static_cast<double>(crossings_s.size() - 2);
  EXPECT_NEAR(1.0 / period_s, 30.0 * std::sqrt(1.0 - 0.05 * 0.05), 0.3);
  // A swing loses 2πζ/√(1 − ζ²) in its logarithm.
  EXPECT_NEAR(std::log(crests[2] / crests[3]), kTwoPi * 0.05, 0.03);
}

TEST(MotionMapping, LosesContactOverItsGap) {
  const PlantMapping mapping = PlantTermsOf(
      StudyKind::kMotion, kNominal,
      std::vector{Cause("backlash",
                        {{"backlash_rad", 0.08}, {"load_inertia_kgm2", 1e-4}, {"load_friction_Nm", 0.01}})});
  const model::PlantParameters plant = PlantOf(mapping).specimen();
  EXPECT_DOUBLE_EQ(plant.deviations.backlash.width_rad, 0.001);
  EXPECT_NEAR(plant.inertia.output_kgm2, 0.64, 1e-12);
  EXPECT_NEAR(plant.inertia.input_kgm2, 2e-4, 1e-15);
  EXPECT_NEAR(plant.load.drag_Nm, 0.8, 1e-12);
}

TEST(MotionMapping, TakesWindowsAndDelays) {
  const model::PlantParameters plant =
      PlantOf(PlantTermsOf(StudyKind::kMotion, kNominal,
                           std::vector{Cause("external_disturbance", {{"start_s", 1.0},
                                                                      {"end_s", 2.0},
                                                                      {"torque_Nm", 0.2},
                                                                      {"start_2_s", 4.0},
                                                                      {"end_2_s", 4.5},
                                                                      {"torque_2_Nm", -0.1},
                                                                      {"edge_share", 0.3}}),
                                       Cause("time_delay", {{"delay_s", 0.004}})}))
          .specimen();
  EXPECT_EQ(plant.drive_causes.disturbance[0].torque_Nm, 0.2);
  EXPECT_EQ(plant.drive_causes.disturbance[1].start_s, 4.0);
  EXPECT_EQ(plant.drive_causes.disturbance[1].torque_Nm, -0.1);
  EXPECT_EQ(plant.drive_causes.disturbance[2].torque_Nm, 0.0);
  EXPECT_EQ(plant.drive_causes.disturbance[1].edge_share, 0.3);
  EXPECT_EQ(plant.drive_causes.delay_s, 0.004);
}

TEST(MotionMapping, SaysWhatTheBenchCannotRun) {
  const auto sentence = [](std::vector<ParameterValue> nominal, std::vector<NamedCause> causes) {
    const PlantMapping mapping = PlantTermsOf(StudyKind::kMotion, nominal, causes);
    return mapping.not_run.size() == 1 ? mapping.not_run[0]
                                       : std::to_string(mapping.not_run.size()) + " sentences";
  };
  EXPECT_EQ(sentence(Values({{"mass_kg", 12.0}}), {}),
            "motion: a linear axis has no place on the simulated bench, which turns");
  EXPECT_EQ(sentence(kNominal, {Cause("time_delay", {{"delay_s", 0.03}})}),
            "time_delay: 0.03 s is more than the bench carries (0.016 s)");
  EXPECT_EQ(sentence(kNominal, {Cause("position_periodic_torque", {{"friction_amplitude_Nm", 0.02},
                                                                   {"friction_phase_deg", 50.0},
                                                                   {"order_per_turn", 12.0}})}),
            "position_periodic_torque: the simulated bench has no friction of such an order and phase");
  EXPECT_EQ(sentence(kNominal, {Cause("solar_wind", {})}),
            "solar_wind: the simulated bench has no term for it");
  EXPECT_EQ(sentence(Values({{"inertia_kgm2", 3.0}, {"coulomb_Nm", 40.0}}), {}),
            "motion: 40 Nm of friction and offset are more than the 7.16 Nm of the bench's servo, which "
            "stands still");
}

model::PlantParameters VibratingPlant(std::vector<NamedCause> causes) {
  const PlantMapping mapping = PlantTermsOf(StudyKind::kVibration,
                                            Values({{"first_amplitude_accel_x_m_per_s2", 0.1},
                                                    {"first_phase_deg_accel_x_m_per_s2", 30.0},
                                                    {"first_amplitude_accel_y_m_per_s2", 0.3},
                                                    {"second_amplitude_accel_x_m_per_s2", 0.4}}),
                                            causes, {.input_speed_rad_per_s = RadPerSFromRpm(1200.0)});
  EXPECT_TRUE(mapping.not_run.empty()) << mapping.not_run[0];
  return PlantOf(mapping).specimen();
}

TEST(VibrationMapping, SpeaksAtTheRecordsSpeed) {
  const model::PlantParameters plant =
      VibratingPlant({Cause("imbalance", {{"amplitude_at_1000_rpm_m_per_s2", 0.05}, {"phase_deg", 90.0}}),
                      Cause("bearing_defect", {{"defect_order", 9.2},
                                               {"amplitude_m_per_s2", 0.2},
                                               {"line_1", 9.2},
                                               {"line_2", 11.2},
                                               {"line_3", 7.2},
                                               {"cosine_1_accel_x_m_per_s2", 0.12},
                                               {"sine_1_accel_x_m_per_s2", -0.16},
                                               {"cosine_2_accel_x_m_per_s2", 0.04},
                                               {"sine_2_accel_x_m_per_s2", 0.0},
                                               {"cosine_3_accel_x_m_per_s2", 0.0},
                                               {"sine_3_accel_x_m_per_s2", 0.06}})});
  // Half the reference speed: the shaft's lines are a quarter of themselves there, the others half.
  EXPECT_NEAR(plant.vibration.order_m_per_s2[0], 0.8, 1e-9);
  EXPECT_NEAR(plant.vibration.order_m_per_s2[1], 1.6, 1e-9);
  EXPECT_NEAR(plant.vibration_causes.bearing.amplitude_m_per_s2, 0.4, 1e-9);
  EXPECT_EQ(plant.vibration_causes.bearing.order, 9.2);
  // Sidebands of 0.04 and 0.06 of a line of 0.2.
  EXPECT_NEAR(plant.vibration_causes.bearing.modulation, 0.5, 1e-9);
  EXPECT_EQ(plant.vibration_causes.imbalance.amplitude_m_per_s2, 0.05);
  EXPECT_NEAR(model::Imbalance_m_per_s2(plant.vibration_causes.imbalance, 0.5 * kPi, RadPerSFromRpm(1000.0)),
              0.05, 1e-12);
}

TEST(VibrationMapping, TakesRingsMeshAndResonance) {
  const model::PlantParameters ringing =
      VibratingPlant({Cause("bearing_defect", {{"defect_order", 9.2},
                                               {"amplitude_m_per_s2", 0.2},
                                               {"ring_Hz", 3000.0},
                                               {"ring_decay_ratio", 0.05}}),
                      Cause("flexspline_crack", {{"crack_order", 2.025},
                                                 {"amplitude_m_per_s2", 0.3},
                                                 {"ring_Hz", 900.0},
                                                 {"ring_decay_ratio", 0.04}}),
                      Cause("torsional_resonance",
                            {{"frequency_Hz", 70.0}, {"damping_ratio", 0.02}, {"amplitude_m_per_s2", 0.1}})});
  EXPECT_NEAR(ringing.vibration_causes.bearing.ringing.amplitude_m_per_s2, 0.4, 1e-9);
  EXPECT_EQ(ringing.vibration_causes.bearing.amplitude_m_per_s2, 0.0);
  EXPECT_EQ(ringing.vibration_causes.crack.ringing.mode_Hz, 900.0);
  EXPECT_NEAR(ringing.vibration_causes.mode.deviation_m_per_s2, 0.2 / std::sqrt(2.0), 1e-9);
  const model::PlantParameters lines =
      VibratingPlant({Cause("gear_mesh", {{"mesh_order", 160.0},
                                          {"amplitude_m_per_s2", 0.1},
                                          {"line_1", 160.0},
                                          {"line_2", 162.0},
                                          {"line_3", 158.0},
                                          {"cosine_1_accel_x_m_per_s2", 0.1},
                                          {"cosine_2_accel_x_m_per_s2", 0.05},
                                          {"cosine_3_accel_x_m_per_s2", 0.01}}),
                      Cause("torsional_resonance", {{"frequency_Hz", 70.0},
                                                    {"damping_ratio", 0.02},
                                                    {"amplitude_m_per_s2", 0.1},
                                                    {"line_1", 2.0},
                                                    {"cosine_1_accel_x_m_per_s2", 0.1}})});
  EXPECT_NEAR(lines.vibration.order_m_per_s2[4], 0.2, 1e-9);
  EXPECT_NEAR(lines.vibration.order_m_per_s2[5], 0.1, 1e-9);
  EXPECT_NEAR(lines.vibration.sideband_depth, 0.2, 1e-9);
  EXPECT_NEAR(lines.vibration_causes.mode.line_m_per_s2, 0.1, 1e-12);
  EXPECT_EQ(lines.vibration_causes.mode.line_order, 2.0);
}

TEST(MappingOfMotion, RejectsWhatItCannotRead) {
  const auto message = [](StudyKind kind, std::vector<NamedCause> causes) -> std::string {
    try {
      PlantTermsOf(kind, {}, causes);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message(StudyKind::kHysteresis, {Cause("torque_zero_offset", {{"offset", 1.0}})}),
            "torque_zero_offset has no parameter offset_Nm");
  EXPECT_EQ(message(StudyKind::kCampaign, {}), "no error");
}

}  // namespace
}  // namespace strainwave::bench::plant_mapping_motion_test
