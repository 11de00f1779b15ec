// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/plant_term_groups.h"

namespace strainwave::analysis::model {

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
        {name, effect, {Amount("amplitude_rad", "rad", a[k]), Nonlinear("phase_rad", "rad", phase[k])}});
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
                    Scale("fastest_s", "s", p.creep.fastest_s), Scale("ratio", "1", p.creep.ratio)}});
}

void AddGearCauses(PlantParameters& p, std::vector<BoundTerm>& terms) {
  TwistDeviations& d = p.deviations;
  terms.push_back(
      {"gear_backlash",
       "E4",
       {Size("width_rad", "rad", d.backlash.width_rad), Scale("torque_Nm", "Nm", d.backlash.torque_Nm),
        Nonlinear("beside_friction", "1", d.backlash_beside_friction)}});
  terms.push_back({"asymmetric_stiffness", "E5", {Amount("asymmetry_share", "1", d.asymmetry_share)}});
  terms.push_back(
      {"cubic_hardening", "E5", {Size("hardening_Nm_per_rad3", "Nm/rad³", d.hardening_Nm_per_rad3)}});
  auto& [second, third] = d.further_friction;
  terms.push_back({"distributed_friction",
                   "E6",
                   {Size("second_friction_torque_Nm", "Nm", second.limit_Nm),
                    Scale("second_yield_twist_rad", "rad", second.yield_rad),
                    Size("third_friction_torque_Nm", "Nm", third.limit_Nm),
                    Scale("third_yield_twist_rad", "rad", third.yield_rad)}});
  terms.push_back(
      {"rate_dependence", "E22", {Size("viscous_Nms_per_rad", "Nm·s/rad", d.viscous_Nms_per_rad)}});
  terms.push_back({"exponential_creep",
                   "E22",
                   {Amount("compliance_rad_per_Nm", "rad/Nm", p.exponential_creep.compliance_rad_per_Nm),
                    Scale("time_constant_s", "s", p.exponential_creep.time_constant_s)}});
  LocalToothDamage& damage = p.kinematic.damage;
  terms.push_back(
      {"local_tooth_damage",
       "E24",
       {Amount("height_rad", "rad", damage.height_rad), Nonlinear("centre_rad", "rad", damage.centre_rad),
        Scale("width_rad", "rad", damage.width_rad), Nonlinear("skew_share", "1", damage.skew_share)}});
}

}  // namespace strainwave::analysis::model
