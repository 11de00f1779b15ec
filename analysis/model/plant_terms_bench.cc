// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/plant_term_groups.h"

namespace strainwave::analysis::model {

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
                    Nonlinear("phase_rad", "rad", out.eccentricity_phase_rad)}});
  BoundTerm position{
      "output_encoder_position_error",
      "E18",
      {Amount("tilt_rad", "rad", out.tilt_rad), Nonlinear("tilt_phase_rad", "rad", out.tilt_phase_rad)}};
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
                    Nonlinear("phase_rad", "rad", in.eccentricity_phase_rad)}});
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
                    Nonlinear("reference_degC", "°C", torque.zero_drift_reference_degC)}});
  terms.push_back({"torque_noise", "", {Amount("noise_Nm", "Nm", torque.noise_Nm)}});
  terms.push_back({"slow_channel_noise",
                   "",
                   {Amount("speed_rad_per_s", "rad/s", p.noise.speed_rad_per_s),
                    Amount("motor_torque_Nm", "Nm", p.noise.motor_torque_Nm),
                    Amount("temperature_K", "K", p.noise.temperature_K),
                    Amount("vibration_share", "1", p.noise.vibration_share)}});
}

void AddMeasuringCauses(PlantParameters& p, std::vector<BoundTerm>& terms) {
  terms.push_back({"torque_zero_offset", "", {Amount("offset_Nm", "Nm", p.transducer.zero_offset_Nm)}});
  terms.push_back({"torque_ageing",
                   "",
                   {Amount("zero_Nm_per_day", "Nm/d", p.transducer.zero_creep_Nm_per_day),
                    Amount("gain_per_day", "1/d", p.transducer.gain_creep_per_day)}});
  terms.push_back({"output_thermal_drift",
                   "E10",
                   {Amount("drift_rad_per_K", "rad/K", p.output_drift.drift_rad_per_K),
                    Nonlinear("reference_degC", "°C", p.output_drift.reference_degC)}});
  terms.push_back({"output_time_drift",
                   "E10",
                   {Amount("rate_rad_per_s", "rad/s", p.output_drift.rate_rad_per_s),
                    Nonlinear("time_constant_s", "s", p.output_drift.time_constant_s)}});
  terms.push_back({"output_swing_drift",
                   "E10",
                   {Amount("swing_rad", "rad", p.output_drift.swing_rad),
                    Nonlinear("period_s", "s", p.output_drift.swing_period_s),
                    Nonlinear("phase_rad", "rad", p.output_drift.swing_phase_rad)}});
}

}  // namespace strainwave::analysis::model
