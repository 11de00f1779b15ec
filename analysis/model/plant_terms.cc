// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/plant_terms.h"

namespace strainwave::analysis::model {
namespace {

// A magnitude that vanishes when its term is off.
BoundParameter Amount(std::string_view name, std::string_view unit, double& value) {
  return {name, unit, &value, 0.0};
}

// A number that only shapes the term (a time, a phase, a place) and stays as it is.
BoundParameter Shape(std::string_view name, std::string_view unit, double& value) {
  return {name, unit, &value, value};
}

// The same where it divides, so that it must be positive.
BoundParameter Scale(std::string_view name, std::string_view unit, double& value) {
  return {name, unit, &value, value, true};
}

void AddGear(PlantParameters& p, std::vector<BoundTerm>& terms) {
  TorsionSpring& spring = p.spring;
  terms.push_back({"torsion_spring",
                   "E5",
                   {{"k1_Nm_per_rad", "Nm/rad", &spring.k1_Nm_per_rad, kRigid_Nm_per_rad, true},
                    {"k2_Nm_per_rad", "Nm/rad", &spring.k2_Nm_per_rad, kRigid_Nm_per_rad, true},
                    {"k3_Nm_per_rad", "Nm/rad", &spring.k3_Nm_per_rad, kRigid_Nm_per_rad, true},
                    Scale("t1_Nm", "Nm", spring.t1_Nm),
                    Scale("t2_Nm", "Nm", spring.t2_Nm)}});
  terms.push_back({"hysteresis",
                   "E6",
                   {Amount("friction_torque_Nm", "Nm", p.hysteresis.limit_Nm),
                    Scale("yield_twist_rad", "rad", p.hysteresis.yield_rad)}});
  auto& a = p.kinematic.amplitude_rad;
  auto& phase = p.kinematic.phase_rad;
  const auto order = [&](std::string_view name, std::string_view effect, std::size_t k) {
    terms.push_back(
        {name, effect, {Amount("amplitude_rad", "rad", a[k]), Shape("phase_rad", "rad", phase[k])}});
  };
  order("kinematic_input_1", "E4", 0);
  order("kinematic_input_2", "E1", 1);
  order("kinematic_input_4", "E1", 2);
  order("kinematic_tooth_engagement", "E2", 3);
  order("kinematic_output_1", "E3", 4);
  order("kinematic_output_2", "E3", 5);
  terms.push_back({"position_dependent_stiffness", "E7", {Amount("ripple", "1", p.stiffness_ripple)}});
  terms.push_back({"creep",
                   "E22",
                   {Amount("share_per_decade", "1", p.creep.share_per_decade),
                    Scale("reference_Nm_per_rad", "Nm/rad", p.creep.reference_Nm_per_rad),
                    Scale("fastest_s", "s", p.creep.fastest_s)}});
}

void AddFriction(PlantParameters& p, std::vector<BoundTerm>& terms) {
  Friction& f = p.friction;
  terms.push_back({"coulomb_friction", "E8", {Amount("coulomb_Nm", "Nm", f.coulomb_Nm)}});
  terms.push_back({"stribeck_friction",
                   "E8",
                   {Amount("breakaway_Nm", "Nm", f.breakaway_Nm),
                    Scale("stribeck_speed_rad_per_s", "rad/s", f.stribeck_speed_rad_per_s)}});
  terms.push_back(
      {"viscous_friction", "E8", {Amount("floor_Nms_per_rad", "Nm·s/rad", f.viscous_floor_Nms_per_rad)}});
  terms.push_back({"thermal_friction",
                   "E10",
                   {Amount("viscous_at_0_degC_Nms_per_rad", "Nm·s/rad", f.viscous_at_0_degC_Nms_per_rad),
                    Scale("viscous_temperature_K", "K", f.viscous_temperature_K)}});
  terms.push_back(
      {"load_dependent_friction", "E9", {Amount("load_coefficient", "Nm/Nm", f.load_coefficient)}});
  terms.push_back({"flexspline_loss",
                   "E11",
                   {Amount("loss_Nm", "Nm", f.flexspline_Nm),
                    Amount("load_coefficient", "Nm/Nm", f.flexspline_load_coefficient)}});
  // Off: a thousandth of a radian, the least that the shortest step resolves.
  terms.push_back({"presliding", "E12", {{"presliding_rad", "rad", &f.presliding_rad, 1e-3, true}}});
  terms.push_back({"position_periodic_friction",
                   "E13",
                   {Amount("share_1", "1", f.periodic_share_1), Amount("share_2", "1", f.periodic_share_2)}});
  Thermal& t = p.thermal;
  terms.push_back({"self_heating",
                   "E10",
                   {Amount("share_of_friction_in_gear", "1", t.share_of_friction_in_gear),
                    Scale("gear_capacity_J_per_K", "J/K", t.gear_capacity_J_per_K),
                    Scale("housing_capacity_J_per_K", "J/K", t.housing_capacity_J_per_K),
                    Scale("gear_to_housing_K_per_W", "K/W", t.gear_to_housing_K_per_W),
                    Scale("housing_to_room_K_per_W", "K/W", t.housing_to_room_K_per_W)}});
  terms.push_back({"motor_heating",
                   "E16",
                   {Amount("loss_W_per_Nm2", "W/Nm²", t.motor_loss_W_per_Nm2),
                    Scale("capacity_J_per_K", "J/K", t.motor_capacity_J_per_K),
                    Scale("to_room_K_per_W", "K/W", t.motor_to_room_K_per_W)}});
  terms.push_back({"day_and_night",
                   "",
                   {Amount("swing_K", "K", p.ambient.swing_K), Shape("mean_degC", "°C", p.ambient.mean_degC),
                    Shape("warmest_at_s", "s", p.ambient.warmest_at_s)}});
}

void AddBench(PlantParameters& p, std::vector<BoundTerm>& terms) {
  terms.push_back({"series_compliance",
                   "E17",
                   {Amount("transducer_rad_per_Nm", "rad/Nm", p.series.transducer_rad_per_Nm),
                    Amount("couplings_rad_per_Nm", "rad/Nm", p.series.couplings_rad_per_Nm)}});
  terms.push_back({"brake_compliance",
                   "E17",
                   {Amount("compliance_rad_per_Nm", "rad/Nm", p.brake.compliance_rad_per_Nm)}});
  terms.push_back({"brake_slip",
                   "",
                   {{"holding_torque_Nm", "Nm", &p.brake.holding_torque_Nm, 1e9, true},
                    Scale("slip_damping_Nms_per_rad", "Nm·s/rad", p.brake.slip_damping_Nms_per_rad)}});
  LoadTrain& load = p.load;
  terms.push_back({"output_drag",
                   "",
                   {Amount("drag_Nm", "Nm", load.drag_Nm),
                    Amount("viscous_Nms_per_rad", "Nm·s/rad", load.drag_viscous_Nms_per_rad),
                    Scale("presliding_rad", "rad", load.drag_presliding_rad)}});
  terms.push_back(
      {"load_motor_ripple",
       "E21",
       {Amount("cogging_Nm", "Nm", load.cogging_Nm), Amount("ripple_share", "1", load.ripple_share),
        Scale("turns_per_output_turn", "1", load.motor_turns_per_output_turn)}});
  terms.push_back({"load_torque_lag", "E21", {Amount("lag_s", "s", load.torque_lag_s)}});
  terms.push_back({"load_unbalance", "E21", {Amount("unbalance_Nm", "Nm", load.unbalance_Nm)}});
  terms.push_back({"torsional_resonance",
                   "E15",
                   {Scale("input_kgm2", "kg·m²", p.inertia.input_kgm2),
                    Scale("output_kgm2", "kg·m²", p.inertia.output_kgm2),
                    Amount("damping_Nms_per_rad", "Nm·s/rad", p.inertia.damping_Nms_per_rad)},
                   &p.has_resonance});
  DrivingServo& servo = p.servo;
  terms.push_back({"motor_cogging", "E16", {Amount("cogging_Nm", "Nm", servo.cogging_Nm)}});
  terms.push_back({"motor_torque_constant", "E16", {Amount("kt_per_K", "1/K", servo.kt_per_K)}});
  terms.push_back({"motor_current_offset", "E16", {Amount("offset_Nm", "Nm", servo.current_offset_Nm)}});
  terms.push_back(
      {"coupling_misalignment", "E19", {Amount("misalignment_rad", "rad", servo.coupling_misalignment_rad)}});
}

void AddMeasuringChain(PlantParameters& p, std::vector<BoundTerm>& terms) {
  Encoder& out = p.output_encoder;
  Encoder& in = p.input_encoder;
  terms.push_back({"output_encoder_eccentricity",
                   "E18",
                   {Amount("amplitude_rad", "rad", out.eccentricity_rad),
                    Shape("phase_rad", "rad", out.eccentricity_phase_rad)}});
  BoundTerm position{
      "output_encoder_position_error",
      "E18",
      {Amount("tilt_rad", "rad", out.tilt_rad), Shape("tilt_phase_rad", "rad", out.tilt_phase_rad)}};
  constexpr std::string_view kNames[] = {"order_3_rad", "order_5_rad", "order_8_rad", "order_13_rad"};
  for (std::size_t i = 0; i < kEncoderOrders.size(); ++i) {
    position.parameters.push_back(Amount(kNames[i], "rad", out.graduation_rad[i]));
  }
  terms.push_back(std::move(position));
  terms.push_back({"output_encoder_interpolation",
                   "E18",
                   {Amount("amplitude_rad", "rad", out.interpolation_rad),
                    Scale("periods_per_turn", "1", out.grating_periods_per_turn)}});
  terms.push_back({"input_encoder_eccentricity",
                   "E18",
                   {Amount("amplitude_rad", "rad", in.eccentricity_rad),
                    Shape("phase_rad", "rad", in.eccentricity_phase_rad)}});
  terms.push_back(
      {"encoder_quantisation",
       "",
       {Amount("input_rad", "rad", in.resolution_rad), Amount("output_rad", "rad", out.resolution_rad)}});
  terms.push_back({"encoder_noise",
                   "",
                   {Amount("input_rad", "rad", in.noise_rad), Amount("output_rad", "rad", out.noise_rad)}});
  TorqueTransducer& torque = p.transducer;
  terms.push_back(
      {"torque_gain_error",
       "",
       {Amount("gain_error", "1", torque.gain_error), Amount("scatter", "1", torque.gain_error_sd)}});
  terms.push_back({"torque_nonlinearity",
                   "",
                   {Amount("share_of_full_scale", "1", torque.nonlinearity),
                    Scale("full_scale_Nm", "Nm", torque.full_scale_Nm)}});
  terms.push_back({"torque_zero_drift",
                   "",
                   {Amount("drift_Nm_per_K", "Nm/K", torque.zero_drift_Nm_per_K),
                    Shape("reference_degC", "°C", torque.zero_drift_reference_degC)}});
  terms.push_back({"torque_noise", "", {Amount("noise_Nm", "Nm", torque.noise_Nm)}});
  terms.push_back({"slow_channel_noise",
                   "",
                   {Amount("speed_rad_per_s", "rad/s", p.noise.speed_rad_per_s),
                    Amount("motor_torque_Nm", "Nm", p.noise.motor_torque_Nm),
                    Amount("temperature_K", "K", p.noise.temperature_K),
                    Amount("vibration_share", "1", p.noise.vibration_share)}});
}

void AddLife(PlantParameters& p, std::vector<BoundTerm>& terms) {
  WearRates& wear = p.wear;
  terms.push_back({"run_in",
                   "E23",
                   {{"life_share", "1", &wear.run_in_life_share, 1e12, true},
                    Amount("tooth_rate", "1", wear.tooth_running_in)}});
  terms.push_back({"tooth_wear",
                   "E23",
                   {Amount("steady", "1", wear.tooth_steady), Amount("late", "1", wear.tooth_late),
                    Amount("grease_coupling", "1", wear.tooth_grease_coupling),
                    Scale("doubling_K", "K", wear.tooth_doubling_K)}});
  terms.push_back(
      {"flexspline_fatigue",
       "E23",
       {Amount("start", "1", wear.flexspline_start), Amount("growth", "1", wear.flexspline_growth)}});
  terms.push_back(
      {"grease_ageing",
       "E23",
       {Amount("rate", "1", wear.grease_rate), Scale("doubling_K", "K", wear.grease_doubling_K)}});
  SpecimenScatter& sd = p.scatter;
  terms.push_back({"specimen_scatter",
                   "E25",
                   {Amount("stiffness", "1", sd.stiffness), Amount("kinematic", "1", sd.kinematic),
                    Amount("friction", "1", sd.friction), Amount("wear_rate", "1", sd.wear_rate),
                    Amount("wear_effect", "1", sd.wear_effect), Amount("vibration", "1", sd.vibration)}});
  terms.push_back(
      {"seating_scatter",
       "E25",
       {Amount("stiffness", "1", p.seating.stiffness), Amount("kinematic", "1", p.seating.kinematic)}});
  Vibration& v = p.vibration;
  BoundTerm shaft{"vibration_orders", "E14", {}};
  constexpr std::string_view kOrderNames[] = {"input_1_m_per_s2", "input_2_m_per_s2",  "input_4_m_per_s2",
                                              "tooth_m_per_s2",   "mesh_160_m_per_s2", "mesh_162_m_per_s2"};
  for (std::size_t k = 0; k < 3; ++k)
    shaft.parameters.push_back(Amount(kOrderNames[k], "m/s²", v.order_m_per_s2[k]));
  terms.push_back(std::move(shaft));
  BoundTerm mesh{"vibration_tooth_mesh", "E2", {}};
  for (std::size_t k = 3; k < kVibrationOrders; ++k) {
    mesh.parameters.push_back(Amount(kOrderNames[k], "m/s²", v.order_m_per_s2[k]));
  }
  mesh.parameters.push_back(Amount("sideband_depth", "1", v.sideband_depth));
  mesh.parameters.push_back(Amount("output_modulation", "1", v.output_modulation));
  terms.push_back(std::move(mesh));
  BoundTerm modes{"vibration_resonances", "", {}};
  constexpr std::string_view kModeNames[][3] = {{"mode_1_m_per_s2", "mode_1_Hz", "mode_1_damping"},
                                                {"mode_2_m_per_s2", "mode_2_Hz", "mode_2_damping"},
                                                {"mode_3_m_per_s2", "mode_3_Hz", "mode_3_damping"}};
  for (std::size_t m = 0; m < kVibrationModes; ++m) {
    modes.parameters.push_back(Amount(kModeNames[m][0], "m/s²", v.mode_m_per_s2[m]));
    modes.parameters.push_back(Scale(kModeNames[m][1], "Hz", v.mode_Hz[m]));
    modes.parameters.push_back(Scale(kModeNames[m][2], "1", v.mode_damping[m]));
  }
  terms.push_back(std::move(modes));
  terms.push_back({"vibration_noise",
                   "",
                   {Amount("broadband_m_per_s2", "m/s²", v.broadband_m_per_s2),
                    Amount("sensor_m_per_s2", "m/s²", v.sensor_noise_m_per_s2)}});
  terms.push_back(
      {"vibration_drift",
       "",
       {Amount("sensor_drift", "1", v.sensor_drift), Amount("scatter_per_run", "1", v.scatter_per_run)}});
}

}  // namespace

std::vector<BoundTerm> BindTerms(PlantParameters& parameters) {
  std::vector<BoundTerm> terms;
  AddGear(parameters, terms);
  AddFriction(parameters, terms);
  AddBench(parameters, terms);
  AddMeasuringChain(parameters, terms);
  AddLife(parameters, terms);
  return terms;
}

}  // namespace strainwave::analysis::model
