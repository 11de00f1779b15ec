// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/plant_term_groups.h"

namespace strainwave::analysis::model {

void AddFriction(PlantParameters& p, std::vector<BoundTerm>& terms) {
  Friction& f = p.friction;
  terms.push_back({"coulomb_friction", "E8", {Amount("coulomb_Nm", "Nm", f.coulomb_Nm)}});
  terms.push_back({"stribeck_friction",
                   "E8",
                   {Amount("breakaway_Nm", "Nm", f.breakaway_Nm),
                    Scale("stribeck_speed_rad_per_s", "rad/s", f.stribeck_speed_rad_per_s),
                    Scale("stribeck_exponent", "1", f.stribeck_exponent)}});
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
  terms.push_back(
      {"day_and_night",
       "",
       {Amount("swing_K", "K", p.ambient.swing_K), Nonlinear("mean_degC", "°C", p.ambient.mean_degC),
        Nonlinear("warmest_at_s", "s", p.ambient.warmest_at_s)}});
}

void AddDriveCauses(PlantParameters& p, std::vector<BoundTerm>& terms) {
  DriveCauses& d = p.drive_causes;
  terms.push_back({"friction_drift",
                   "E10",
                   {Amount("share_per_K", "1/K", p.friction.drift.share_per_K),
                    Nonlinear("reference_degC", "°C", p.friction.drift.reference_degC),
                    Amount("share_per_h", "1/h", p.friction.drift.share_per_h)}});
  terms.push_back({"asymmetric_viscous_friction",
                   "E8",
                   {Amount("difference_Nms_per_rad", "Nm·s/rad", d.viscous_difference_Nms_per_rad)}});
  terms.push_back(
      {"quadratic_drag", "E8", {Amount("drag_Nms2_per_rad2", "Nm·s²/rad²", d.quadratic_Nms2_per_rad2)}});
  terms.push_back(
      {"input_periodic_torque",
       "E16",
       {Amount("amplitude_Nm", "Nm", d.periodic.amplitude_Nm), Scale("order_per_turn", "1", d.periodic.order),
        Nonlinear("phase_rad", "rad", d.periodic.phase_rad)}});
  terms.push_back({"input_unbalance",
                   "E21",
                   {Amount("amplitude_Nm", "Nm", d.unbalance.amplitude_Nm),
                    Nonlinear("phase_rad", "rad", d.unbalance.phase_rad)}});
  terms.push_back({"input_constant_torque", "", {Amount("torque_Nm", "Nm", d.constant_Nm)}});
  constexpr std::string_view kWindows[][4] = {{"torque_Nm", "start_s", "end_s", "edge_share"},
                                              {"torque_2_Nm", "start_2_s", "end_2_s", "edge_share_2"},
                                              {"torque_3_Nm", "start_3_s", "end_3_s", "edge_share_3"}};
  BoundTerm disturbance{"external_disturbance", "", {}};
  for (std::size_t w = 0; w < d.disturbance.size(); ++w) {
    TorqueWindow& window = d.disturbance[w];
    disturbance.parameters.push_back(Amount(kWindows[w][0], "Nm", window.torque_Nm));
    disturbance.parameters.push_back(Nonlinear(kWindows[w][1], "s", window.start_s));
    disturbance.parameters.push_back(Nonlinear(kWindows[w][2], "s", window.end_s));
    disturbance.parameters.push_back(Nonlinear(kWindows[w][3], "1", window.edge_share));
  }
  terms.push_back(std::move(disturbance));
  BrakeYield& yield = p.brake.yield;
  terms.push_back({"brake_yield",
                   "E17",
                   {Size("speed_rad_per_s", "rad/s", yield.speed_rad_per_s),
                    Size("each_time_rad_per_Nm", "rad/Nm", yield.each_time_rad_per_Nm),
                    Size("only_further_rad_per_Nm", "rad/Nm", yield.only_further_rad_per_Nm),
                    Size("once_rad", "rad", yield.once_rad)}});
  terms.push_back({"drive_time_delay", "E20", {Size("delay_s", "s", d.delay_s)}});
}

}  // namespace strainwave::analysis::model
