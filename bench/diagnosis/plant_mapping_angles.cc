// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "analysis/model/plant_parameters.h"
#include "analysis/units.h"
#include "bench/diagnosis/plant_mapping_parts.h"

/// Records of angles: transmission error and hysteresis.
namespace strainwave::bench::mapping {

namespace model = analysis::model;

namespace {

// Drift of the output angle; the sign says which way the output angle goes with the measured quantity.
// `drift` in arcmin is per K, or already what the output has drifted by in the end.
void MapDriftPerK(double drift_arcmin_per_K, const MappingContext& context, PlantTerms& plant) {
  plant.Set("output_thermal_drift", {{"drift_rad_per_K", RadFromArcmin(drift_arcmin_per_K)},
                                     {"reference_degC", context.temperature_degC}});
}

void MapDriftRate(double rate_rad_per_s, double time_constant_s, PlantTerms& plant) {
  plant.Set("output_time_drift", {{"rate_rad_per_s", rate_rad_per_s}, {"time_constant_s", time_constant_s}});
}

// Half the difference between the directions that the bench has by itself: the drag of its load train winds
// up gear and couplings, below the torque at which the gear's friction slips.
double OwnDirectionDifference_rad() {
  const model::PlantParameters plant;
  const double drag_Nm = plant.load.drag_Nm;
  const double stiffness = plant.spring.k1_Nm_per_rad + plant.hysteresis.stiffness_Nm_per_rad();
  return 2.0 * drag_Nm * (1.0 / stiffness + plant.series.total_rad_per_Nm());
}

void MapErrorBacklash(const NamedCause& cause, PlantTerms& plant) {
  const double width_rad = RadFromArcmin(Require(cause, "backlash_arcmin"));
  const double own_rad = OwnDirectionDifference_rad();
  if (width_rad <= own_rad) {
    plant.Say(
        fmt::format("backlash: the bench's own drag makes {:.2f} arcmin between the directions, the model "
                    "{:.2f}; the bench runs its own",
                    ArcminFromRad(own_rad), ArcminFromRad(width_rad)));
    return;
  }
  plant.Set("gear_backlash", {{"width_rad", width_rad - own_rad}});
}

void MapErrorDrift(const NamedCause& cause, const MappingContext& context, PlantTerms& plant) {
  if (const auto per_K = Find(cause.parameters, "drift_arcmin_per_K")) {
    MapDriftPerK(-*per_K, context, plant);
  } else if (const auto per_h = Find(cause.parameters, "drift_arcmin_per_h")) {
    // The mean rate over the record; what settles is faster at the start.
    const double mean_rad_per_s = RadFromArcmin(*per_h) / SecondsFromHours(1.0);
    const double constant_s = Find(cause.parameters, "time_constant_s").value_or(0.0);
    const double spans = constant_s > 0.0 ? context.duration_s / constant_s : 0.0;
    const double faster = spans > 0.0 ? spans / -std::expm1(-spans) : 1.0;
    MapDriftRate(-faster * mean_rad_per_s, spans > 0.0 ? constant_s : 0.0, plant);
  } else if (const auto swing = Find(cause.parameters, "drift_swing_arcmin");
             swing && Find(cause.parameters, "period_s")) {
    // The error is the cosine of the phase behind its crest; the output goes the other way.
    plant.Set("output_swing_drift", {{"swing_rad", RadFromArcmin(*swing)},
                                     {"period_s", *Find(cause.parameters, "period_s")},
                                     {"phase_rad", -0.5 * kPi - RadFromDeg(Require(cause, "phase_deg"))}});
  } else {
    plant.Say("thermal_drift: it follows neither temperature nor time, but the number of the sample");
  }
}

void MapWindup(const NamedCause& cause, PlantTerms& plant) {
  const double windup = Require(cause, "windup_arcmin_per_Nm");
  if (windup > 0.0) {
    plant.Say("load_windup: the record counts torque against the bench, which winds up the other way");
  }
  // Everything between the encoders; the gear takes what the bench's own couplings leave.
  const double total_rad_per_Nm = RadFromArcmin(std::abs(windup));
  double gear_rad_per_Nm = total_rad_per_Nm - model::SeriesCompliance{}.total_rad_per_Nm();
  if (!(gear_rad_per_Nm > 0.1 * total_rad_per_Nm)) {
    gear_rad_per_Nm = total_rad_per_Nm;
    plant.Off({"series_compliance"});
  }
  const double stiffness = 1.0 / gear_rad_per_Nm;
  plant.Set("torsion_spring",
            {{"k1_Nm_per_rad", stiffness}, {"k2_Nm_per_rad", stiffness}, {"k3_Nm_per_rad", stiffness}});
  plant.Off({"hysteresis", "position_dependent_stiffness"});
}

// At the output in arcmin → at the motor shaft, where the brake is.
void MapBrakeSlip(const NamedCause& cause, const MappingContext& context, PlantTerms& plant) {
  const double n = context.ratio;
  const Parameters p = cause.parameters;
  plant.Set("brake_slip", {{"holding_torque_Nm", Require(cause, "slip_torque_Nm") / n}});
  constexpr double kNoDamper_Nms_per_rad = 1e9;  // beyond what it holds it does not creep by itself
  if (const auto rate = Find(p, "slip_arcmin_per_Nms")) {
    plant.Set("brake_slip", {{"slip_damping_Nms_per_rad", 1.0 / (n * n * RadFromArcmin(*rate))}});
    return;
  }
  plant.Set("brake_slip", {{"slip_damping_Nms_per_rad", kNoDamper_Nms_per_rad}});
  if (const auto speed = Find(p, "slip_arcmin_per_s")) {
    plant.Set("brake_yield", {{"speed_rad_per_s", n * RadFromArcmin(*speed)}});
  } else if (const auto each = Find(p, "slip_each_time_arcmin_per_Nm")) {
    plant.Set("brake_yield", {{"each_time_rad_per_Nm", n * n * RadFromArcmin(*each)}});
  } else if (const auto further = Find(p, "slip_arcmin_per_Nm")) {
    plant.Set("brake_yield", {{"only_further_rad_per_Nm", n * n * RadFromArcmin(*further)}});
  } else {
    plant.Set("brake_yield", {{"once_rad", n * RadFromArcmin(Require(cause, "slip_arcmin"))}});
  }
}

// Over all of the twist up to T₂.
double MeanStiffness_Nm_per_rad(Parameters nominal, const MappingContext& context) {
  const model::TorsionSpring own;
  const model::TorsionSpring spring{Find(nominal, "k1_Nm_per_rad").value_or(own.k1_Nm_per_rad),
                                    Find(nominal, "k2_Nm_per_rad").value_or(own.k2_Nm_per_rad),
                                    Find(nominal, "k3_Nm_per_rad").value_or(own.k3_Nm_per_rad), context.t1_Nm,
                                    context.t2_Nm};
  return context.t2_Nm / model::SpringTwist(spring, context.t2_Nm);
}

// The plant's gear is stiffer one way in all of its segments or in none.
void MapAsymmetry(const NamedCause& cause, PlantTerms& plant) {
  auto share = Find(cause.parameters, "asymmetry_share");
  // The plant's knees stay at their torques, also where those of the record are at one twist.
  if (!share) share = Find(cause.parameters, "law_asymmetry_share");
  if (share) {
    plant.Set("asymmetric_stiffness", {{"asymmetry_share", *share}});
  } else {
    SayUnknown(cause, plant);
  }
}

// The plant has a damper beside the spring. A lag of the twist, or of the torque that is felt, is that of one
// over the mean stiffness; friction that rises with the rate holds back as much as one does at the usual
// rate.
void MapRateDependence(const NamedCause& cause, Parameters nominal, const MappingContext& context,
                       PlantTerms& plant) {
  const double stiffness = MeanStiffness_Nm_per_rad(nominal, context);
  const auto damper_for = [&](double rise_share) {
    return rise_share * Find(nominal, "friction_torque_Nm").value_or(0.0) * stiffness /
           Require(cause, "usual_rate_Nm_per_s");
  };
  double viscous = 0.0;
  if (const auto lag = Find(cause.parameters, "lag_rad_s_per_Nm")) {
    viscous = *lag * stiffness * stiffness;
  } else if (const auto lag_s = Find(cause.parameters, "torque_lag_s")) {
    viscous = *lag_s * stiffness;
  } else if (const auto rise = Find(cause.parameters, "friction_rise_share")) {
    viscous = damper_for(*rise * std::log(2.0));
  } else if (const auto straight = Find(cause.parameters, "linear_friction_rise_share")) {
    viscous = damper_for(*straight);
  } else {
    viscous = Require(cause, "viscous_Nms_per_rad");
  }
  plant.Set("rate_dependence", {{"viscous_Nms_per_rad", viscous}});
}

void MapCreep(const NamedCause& cause, Parameters nominal, const MappingContext& context, PlantTerms& plant) {
  const double constant_s = Require(cause, "time_constant_s");
  // The plant's creep goes with torque; where it was found to be a share of the gear's twist, that is changed
  // over.
  const double stiffness = MeanStiffness_Nm_per_rad(nominal, context);
  const auto share_of = [&](const char* of_twist, const char* of_torque) -> std::optional<double> {
    if (const auto share = Find(cause.parameters, of_twist)) return share;
    if (const auto torque = Find(cause.parameters, of_torque)) return RadFromArcmin(*torque) * stiffness;
    return std::nullopt;
  };
  if (const auto per_decade = share_of("creep_share_per_decade", "creep_arcmin_per_Nm_per_decade")) {
    // Elements a decade apart from τ on go as log₁₀(1 + t/t₀) with τ = t₀ · 10^(½ + γ/ln 10), γ = 0.5772.
    constexpr double kFastestOverOnset = 5.632;
    plant.Set("creep", {{"share_per_decade", *per_decade},
                        {"reference_Nm_per_rad", stiffness},
                        {"fastest_s", kFastestOverOnset * constant_s},
                        {"ratio", 10.0}});
    return;
  }
  const auto share = share_of("creep_share", "creep_arcmin_per_Nm");
  const double all = share ? *share : Require(cause, "creep_share");
  // A band without a width is one element.
  const auto longest_s = Find(cause.parameters, "longest_time_constant_s");
  if (longest_s && *longest_s > constant_s) {
    // Each element stands in the middle of its part of the band's octaves.
    const double ratio = std::pow(*longest_s / constant_s, 1.0 / model::kCreepElements);
    plant.Set("creep", {{"share_per_decade", all / model::kCreepElements / std::log10(ratio)},
                        {"reference_Nm_per_rad", stiffness},
                        {"fastest_s", constant_s * std::sqrt(ratio)},
                        {"ratio", ratio}});
    return;
  }
  plant.Set("exponential_creep",
            {{"compliance_rad_per_Nm", all / stiffness}, {"time_constant_s", constant_s}});
}

void MapFurtherFriction(const NamedCause& cause, PlantTerms& plant) {
  plant.Set("distributed_friction",
            {{"second_friction_torque_Nm", Require(cause, "second_friction_torque_Nm")},
             {"second_yield_twist_rad", RadFromArcmin(Require(cause, "second_yield_twist_arcmin"))}});
  if (!Find(cause.parameters, "third_friction_torque_Nm")) return;
  plant.Set("distributed_friction",
            {{"third_friction_torque_Nm", Require(cause, "third_friction_torque_Nm")},
             {"third_yield_twist_rad", RadFromArcmin(Require(cause, "third_yield_twist_arcmin"))}});
}

void MapLoopDrift(const NamedCause& cause, const MappingContext& context, PlantTerms& plant) {
  if (const auto per_K = Find(cause.parameters, "drift_arcmin_per_K")) {
    MapDriftPerK(*per_K, context, plant);
  } else if (const auto per_min = Find(cause.parameters, "drift_arcmin_per_min")) {
    MapDriftRate(RadFromArcmin(*per_min) / 60.0, 0.0, plant);
  } else {
    const double constant_s = Require(cause, "time_constant_s");
    MapDriftRate(RadFromArcmin(Require(cause, "drift_arcmin")) / constant_s, constant_s, plant);
  }
}

}  // namespace

void MapTransmissionError(Parameters nominal, std::span<const NamedCause> causes,
                          const MappingContext& context, PlantTerms& plant) {
  plant.Off({"kinematic_input_1", "kinematic_input_4", "kinematic_tooth_engagement", "kinematic_output_1",
             "kinematic_output_2", "output_encoder_eccentricity", "output_encoder_position_error",
             "input_encoder_eccentricity", "coupling_misalignment"});
  const auto line = [&](std::string_view term, double amplitude_arcmin, double phase_deg) {
    plant.Set(term,
              {{"amplitude_rad", RadFromArcmin(amplitude_arcmin)}, {"phase_rad", SinePhase_rad(phase_deg)}});
  };
  if (const auto amplitude = Find(nominal, "second_harmonic_amplitude_arcmin")) {
    line("kinematic_input_2", *amplitude, Find(nominal, "second_harmonic_phase_deg").value_or(0.0));
  }
  static const std::map<std::string_view, std::string_view> kLines{
      {"wave_generator_first_harmonic", "kinematic_input_1"},
      {"wave_generator_fourth_harmonic", "kinematic_input_4"},
      {"tooth_engagement", "kinematic_tooth_engagement"},
      {"output_eccentricity", "kinematic_output_1"},
      {"circular_spline_ovality", "kinematic_output_2"}};
  for (const NamedCause& cause : causes) {
    if (const auto known = kLines.find(cause.name); known != kLines.end()) {
      line(known->second, Require(cause, "amplitude_arcmin"), Require(cause, "phase_deg"));
    } else if (cause.name == "backlash") {
      MapErrorBacklash(cause, plant);
    } else if (cause.name == "thermal_drift") {
      MapErrorDrift(cause, context, plant);
    } else if (cause.name == "local_tooth_damage") {
      plant.Set("local_tooth_damage", {{"height_rad", RadFromArcmin(Require(cause, "height_arcmin"))},
                                       {"centre_rad", RadFromDeg(Require(cause, "centre_deg"))},
                                       {"width_rad", RadFromDeg(Require(cause, "width_deg"))},
                                       {"skew_share", Require(cause, "skew_share")}});
    } else if (cause.name == "load_windup") {
      MapWindup(cause, plant);
    } else {
      SayUnknown(cause, plant);
    }
  }
}

void MapHysteresis(Parameters nominal, std::span<const NamedCause> causes, const MappingContext& context,
                   PlantTerms& plant) {
  plant.Off({"series_compliance", "brake_compliance", "position_dependent_stiffness", "creep"});
  plant.Set("torsion_spring", {{"t1_Nm", context.t1_Nm}, {"t2_Nm", context.t2_Nm}});
  for (const std::string_view name : {"k1_Nm_per_rad", "k2_Nm_per_rad", "k3_Nm_per_rad"}) {
    if (const auto stiffness = Find(nominal, name)) plant.Set("torsion_spring", {{name, *stiffness}});
  }
  if (const auto friction = Find(nominal, "friction_torque_Nm")) {
    plant.Set("hysteresis", {{"friction_torque_Nm", *friction}});
  }
  if (const auto yield = Find(nominal, "yield_twist_arcmin")) {
    plant.Set("hysteresis", {{"yield_twist_rad", RadFromArcmin(*yield)}});
  }
  for (const NamedCause& cause : causes) {
    if (cause.name == "backlash") {
      plant.Set("gear_backlash", {{"width_rad", RadFromArcmin(Require(cause, "backlash_arcmin"))}});
      if (const auto torque = Find(cause.parameters, "dead_zone_torque_Nm")) {
        plant.Set("gear_backlash", {{"torque_Nm", *torque}});
      }
      if (const auto beside = Find(cause.parameters, "beside_friction")) {
        plant.Set("gear_backlash", {{"beside_friction", *beside}});
      }
    } else if (cause.name == "asymmetric_stiffness") {
      MapAsymmetry(cause, plant);
    } else if (cause.name == "cubic_hardening") {
      plant.Set("cubic_hardening", {{"hardening_Nm_per_rad3", Require(cause, "hardening_Nm_per_rad3")}});
    } else if (cause.name == "creep") {
      MapCreep(cause, nominal, context, plant);
    } else if (cause.name == "brake_slip") {
      MapBrakeSlip(cause, context, plant);
    } else if (cause.name == "thermal_drift") {
      MapLoopDrift(cause, context, plant);
    } else if (cause.name == "torque_zero_offset") {
      plant.Set("torque_zero_offset", {{"offset_Nm", Require(cause, "offset_Nm")}});
    } else if (cause.name == "distributed_friction") {
      MapFurtherFriction(cause, plant);
    } else if (cause.name == "rate_dependence") {
      MapRateDependence(cause, nominal, context, plant);
    } else {
      SayUnknown(cause, plant);
    }
  }
}

}  // namespace strainwave::bench::mapping
