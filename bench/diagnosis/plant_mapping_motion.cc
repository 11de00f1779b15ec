// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/model/plant_parameters.h"
#include "analysis/units.h"
#include "bench/diagnosis/plant_mapping_parts.h"

/// Records of motion: the axis is the bench's input shaft.
namespace strainwave::bench::mapping {

namespace model = analysis::model;

namespace {

constexpr double kLeastInertia_kgm2 = 1e-7;

// The rigid whole of the inertias, at the input, shared between both sides of the gear.
void SetInertias(double input_kgm2, double output_at_input_kgm2, const MappingContext& context,
                 PlantTerms& plant) {
  plant.Set("torsional_resonance", {{"input_kgm2", std::max(input_kgm2, kLeastInertia_kgm2)},
                                    {"output_kgm2", std::max(output_at_input_kgm2, kLeastInertia_kgm2) *
                                                        context.ratio * context.ratio}});
}

void MapResonance(const NamedCause& cause, double inertia_kgm2, const MappingContext& context,
                  PlantTerms& plant) {
  const double second_kgm2 =
      Find(cause.parameters, "second_inertia_kgm2")
          .value_or(Find(cause.parameters, "inertia_share").value_or(0.0) * inertia_kgm2);
  if (!(second_kgm2 > 0.0 && second_kgm2 < inertia_kgm2)) {
    plant.Say(
        fmt::format("torsional_resonance: a second inertia of {:.3g} kgm2 behind the whole of {:.3g} kgm2 "
                    "cannot be shared between motor and load",
                    second_kgm2, inertia_kgm2));
    return;
  }
  // The frequency is that of the second inertia with the near side held.
  const double natural_rad_per_s = kTwoPi * Require(cause, "frequency_Hz");
  const double damping_ratio = Require(cause, "damping_ratio");
  const double at_output = context.ratio * context.ratio * second_kgm2;
  const double stiffness = at_output * natural_rad_per_s * natural_rad_per_s;
  SetInertias(inertia_kgm2 - second_kgm2, second_kgm2, context, plant);
  plant.Set("torsional_resonance",
            {{"damping_Nms_per_rad", 2.0 * damping_ratio * natural_rad_per_s * at_output}});
  plant.Set("torsion_spring",
            {{"k1_Nm_per_rad", stiffness}, {"k2_Nm_per_rad", stiffness}, {"k3_Nm_per_rad", stiffness}});
  plant.Off({"hysteresis", "series_compliance", "position_dependent_stiffness", "creep"});
}

void MapMotionBacklash(const NamedCause& cause, double inertia_kgm2, const MappingContext& context,
                       PlantTerms& plant) {
  plant.Set("gear_backlash", {{"width_rad", Require(cause, "backlash_rad") / context.ratio}});
  const double load_kgm2 = Find(cause.parameters, "load_inertia_kgm2").value_or(0.0);
  if (load_kgm2 > 0.0 && load_kgm2 < inertia_kgm2) {
    SetInertias(inertia_kgm2 - load_kgm2, load_kgm2, context, plant);
  }
  const double friction_Nm = Find(cause.parameters, "load_friction_Nm").value_or(0.0);
  if (friction_Nm > 0.0) plant.Set("output_drag", {{"drag_Nm", friction_Nm * context.ratio}});
}

void MapDisturbance(const NamedCause& cause, PlantTerms& plant) {
  const double edge_share = Find(cause.parameters, "edge_share").value_or(0.0);
  for (const char* window : {"", "_2", "_3"}) {
    const auto name = [window](const char* what, const char* unit) {
      return fmt::format("{}{}{}", what, window, unit);
    };
    const std::string torque = name("torque", "_Nm");
    if (!Find(cause.parameters, torque)) continue;
    const std::string start = name("start", "_s");
    const std::string end = name("end", "_s");
    plant.Set("external_disturbance", {{torque, Require(cause, torque)},
                                       {start, Require(cause, start)},
                                       {end, Require(cause, end)},
                                       {name("edge_share", ""), edge_share}});
  }
  if (Find(cause.parameters, "torque_4_Nm")) {
    plant.Say("external_disturbance: the bench runs three windows, the model has more");
  }
}

void MapDelay(const NamedCause& cause, PlantTerms& plant) {
  const double delay_s = Require(cause, "delay_s");
  if (delay_s > model::kLongestDriveDelay_s) {
    plant.Say(fmt::format("time_delay: {:.3g} s is more than the bench carries ({} s)", delay_s,
                          model::kLongestDriveDelay_s));
  } else if (delay_s > 0.0) {
    plant.Set("drive_time_delay", {{"delay_s", delay_s}});
    plant.Say("time_delay: acts in steps of 2 ms and shorter only, as the torsional resonance does");
  }
}

void MapFrictionDrift(const NamedCause& cause, const MappingContext& context, PlantTerms& plant) {
  if (const auto per_K = Find(cause.parameters, "drift_per_K")) {
    plant.Set("friction_drift", {{"share_per_K", *per_K}, {"reference_degC", context.temperature_degC}});
  } else {
    plant.Set("friction_drift", {{"share_per_h", Require(cause, "drift_per_h")}});
    if (const auto settles_s = Find(cause.parameters, "time_constant_s")) {
      plant.Say(fmt::format(
          "thermal_friction_drift: goes on at its mean rate, in the model it settles within {:.3g} s",
          *settles_s));
    }
  }
}

}  // namespace

void MapMotion(Parameters nominal, std::span<const NamedCause> causes, const MappingContext& context,
               PlantTerms& plant) {
  plant.Off({"stribeck_friction", "thermal_friction", "load_dependent_friction", "flexspline_loss",
             "position_periodic_friction", "motor_cogging", "motor_current_offset", "output_drag",
             "load_motor_ripple", "load_unbalance"});
  const model::Inertia own;
  const double own_output = own.output_kgm2 / (context.ratio * context.ratio);
  const double inertia = Find(nominal, "inertia_kgm2").value_or(own.input_kgm2 + own_output);
  const double output_part = std::min(own_output, 0.2 * std::max(inertia, 0.0));
  SetInertias(inertia - output_part, output_part, context, plant);
  if (const auto viscous = Find(nominal, "viscous_Nms_per_rad")) {
    plant.Set("viscous_friction", {{"floor_Nms_per_rad", *viscous}});
  }
  const double coulomb_Nm = Find(nominal, "coulomb_Nm").value_or(model::Friction{}.coulomb_Nm);
  plant.Set("coulomb_friction", {{"coulomb_Nm", coulomb_Nm}});
  const double offset_Nm = Find(nominal, "offset_Nm").value_or(0.0);
  plant.Set("input_constant_torque", {{"torque_Nm", offset_Nm}});
  const double peak_Nm = model::DrivingServo{}.peak_torque_Nm;
  if (coulomb_Nm + std::abs(offset_Nm) > peak_Nm) {
    plant.Say(
        fmt::format("motion: {:.3g} Nm of friction and offset are more than the {} Nm of the bench's servo, "
                    "which stands still",
                    coulomb_Nm + std::abs(offset_Nm), peak_Nm));
  }
  for (const NamedCause& cause : causes) {
    if (cause.name == "stribeck_friction") {
      plant.Set("stribeck_friction",
                {{"breakaway_Nm", coulomb_Nm + Require(cause, "stribeck_Nm")},
                 {"stribeck_speed_rad_per_s", Require(cause, "stribeck_speed_rad_per_s")},
                 {"stribeck_exponent", Find(cause.parameters, "stribeck_exponent").value_or(2.0)}});
    } else if (cause.name == "asymmetric_friction") {
      plant.Set("asymmetric_viscous_friction",
                {{"difference_Nms_per_rad", Require(cause, "viscous_difference_Nms_per_rad")}});
    } else if (cause.name == "position_periodic_torque" && Find(cause.parameters, "friction_amplitude_Nm")) {
      plant.Say("position_periodic_torque: the simulated bench has no friction of such an order and phase");
    } else if (cause.name == "position_periodic_torque") {
      plant.Set("input_periodic_torque", {{"amplitude_Nm", Require(cause, "amplitude_Nm")},
                                          {"order_per_turn", Require(cause, "order_per_turn")},
                                          {"phase_rad", SinePhase_rad(Require(cause, "phase_deg"))}});
    } else if (cause.name == "gravity_load") {
      plant.Set("input_unbalance", {{"amplitude_Nm", Require(cause, "amplitude_Nm")},
                                    {"phase_rad", SinePhase_rad(Require(cause, "phase_deg"))}});
    } else if (cause.name == "quadratic_drag") {
      plant.Set("quadratic_drag", {{"drag_Nms2_per_rad2", Require(cause, "drag_Nms2_per_rad2")}});
    } else if (cause.name == "load_dependent_friction") {
      // Of the torque at the input there; the plant's is of the torque at the output.
      plant.Set("load_dependent_friction",
                {{"load_coefficient", Require(cause, "load_coefficient") / context.ratio}});
    } else if (cause.name == "thermal_friction_drift") {
      MapFrictionDrift(cause, context, plant);
    } else if (cause.name == "torsional_resonance") {
      MapResonance(cause, inertia, context, plant);
    } else if (cause.name == "backlash") {
      MapMotionBacklash(cause, inertia, context, plant);
    } else if (cause.name == "time_delay") {
      MapDelay(cause, plant);
    } else if (cause.name == "external_disturbance") {
      MapDisturbance(cause, plant);
    } else {
      SayUnknown(cause, plant);
    }
  }
}

}  // namespace strainwave::bench::mapping
