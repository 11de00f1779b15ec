// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "analysis/model/vibration.h"
#include "analysis/units.h"
#include "bench/diagnosis/plant_mapping_parts.h"

/// Records of vibration. The plant's amplitudes are those at its reference speed.
namespace strainwave::bench::mapping {

namespace model = analysis::model;

namespace {

// Mean over the parameters whose names begin so, one a channel.
std::optional<double> MeanOf(Parameters parameters, std::string_view prefix) {
  double sum = 0.0;
  int count = 0;
  for (const auto& parameter : parameters) {
    if (!parameter.name.starts_with(prefix)) continue;
    sum += parameter.value;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

// Mean over the channels of the amplitude of a line at an order, from its cosines and sines; nothing where
// the model has no such line.
std::optional<double> LineAmplitude(Parameters parameters, double order) {
  for (int line = 1;; ++line) {
    const std::optional<double> at = Find(parameters, fmt::format("line_{}", line));
    if (!at) return std::nullopt;
    if (std::abs(*at - order) > 1e-3 * order) continue;
    double sum = 0.0;
    int channels = 0;
    const std::string cosine = fmt::format("cosine_{}_", line);
    for (const auto& parameter : parameters) {
      if (!parameter.name.starts_with(cosine)) continue;
      const std::string channel = parameter.name.substr(cosine.size());
      sum += std::hypot(parameter.value,
                        Find(parameters, fmt::format("sine_{}_{}", line, channel)).value_or(0.0));
      ++channels;
    }
    if (channels > 0) return sum / channels;
  }
}

// Depth of a modulation by what lies `offset` to either side of a line: each side is half the depth of it.
double DepthOf(Parameters parameters, double order, double offset, double amplitude) {
  if (!(amplitude > 0.0)) return 0.0;
  return (LineAmplitude(parameters, order - offset).value_or(0.0) +
          LineAmplitude(parameters, order + offset).value_or(0.0)) /
         amplitude;
}

// Speed over the reference speed.
double RelativeSpeed(const MappingContext& context) {
  const double reference = model::Vibration{}.reference_speed_rad_per_s;
  return context.input_speed_rad_per_s > 0.0 ? context.input_speed_rad_per_s / reference : 1.0;
}

void MapMesh(const NamedCause& cause, const MappingContext& context, PlantTerms& plant) {
  const Parameters p = cause.parameters;
  const double order = Require(cause, "mesh_order");
  constexpr double kFlexspline = 160.0, kCircularSpline = 162.0;  // where the plant meshes
  const bool by_flexspline = std::abs(order - kFlexspline) < 1.0;
  if (!by_flexspline && std::abs(order - kCircularSpline) >= 1.0) {
    plant.Say(fmt::format("gear_mesh: the simulated gear meshes at 160 and 162 per input turn, not at {:.4g}",
                          order));
    return;
  }
  const double largest = Require(cause, "amplitude_m_per_s2");
  const double flexspline = LineAmplitude(p, kFlexspline).value_or(by_flexspline ? largest : 0.0);
  const double circular = LineAmplitude(p, kCircularSpline).value_or(by_flexspline ? 0.0 : largest);
  const double own = by_flexspline ? kFlexspline : kCircularSpline;
  const double of_own = by_flexspline ? flexspline : circular;
  // The side towards the other mesh order is not a sideband alone.
  const double outer = LineAmplitude(p, by_flexspline ? own - 2.0 : own + 2.0).value_or(0.0);
  plant.Set("vibration_tooth_mesh", {{"tooth_m_per_s2", 0.0},
                                     {"mesh_160_m_per_s2", flexspline / RelativeSpeed(context)},
                                     {"mesh_162_m_per_s2", circular / RelativeSpeed(context)},
                                     {"sideband_depth", of_own > 0.0 ? 2.0 * outer / of_own : 0.0},
                                     {"output_modulation", DepthOf(p, own, 1.0 / context.ratio, of_own)}});
}

// Lines at a passing order, or a mode that rings at each passing.
void MapPassings(const NamedCause& cause, std::string_view term, double order, double sideband,
                 const MappingContext& context, PlantTerms& plant) {
  const Parameters p = cause.parameters;
  const double largest = Require(cause, "amplitude_m_per_s2") / RelativeSpeed(context);
  if (const auto ring_Hz = Find(p, "ring_Hz")) {
    plant.Set(term, {{"ringing_m_per_s2", largest},
                     {"mode_Hz", *ring_Hz},
                     {"mode_damping", Require(cause, "ring_decay_ratio")},
                     {"modulation", 0.0}});
    return;
  }
  const std::optional<double> line = LineAmplitude(p, order);
  plant.Set(term, {{"amplitude_m_per_s2", line ? *line / RelativeSpeed(context) : largest},
                   {"modulation", line ? DepthOf(p, order, sideband, *line) : 0.0}});
}

void MapMode(const NamedCause& cause, const MappingContext& context, PlantTerms& plant) {
  const Parameters p = cause.parameters;
  constexpr std::string_view kTerm = "vibration_torsional_resonance";
  const double amplitude = Require(cause, "amplitude_m_per_s2");
  plant.Set(kTerm,
            {{"frequency_Hz", Require(cause, "frequency_Hz")}, {"damping", Require(cause, "damping_ratio")}});
  if (!Find(p, "line_1")) {
    // Rung by noise: an amplitude of √2 standard deviations.
    plant.Set(kTerm, {{"deviation_m_per_s2", amplitude / std::sqrt(2.0) / RelativeSpeed(context)}});
    return;
  }
  // Lines of the shaft that meet it: the bench runs the strongest.
  double order = 0.0;
  double strongest = -1.0;
  for (int line = 1;; ++line) {
    const std::optional<double> at = Find(p, fmt::format("line_{}", line));
    if (!at) break;
    const double size = LineAmplitude(p, *at).value_or(0.0);
    if (size > strongest) {
      strongest = size;
      order = *at;
    }
  }
  plant.Set(kTerm, {{"line_m_per_s2", strongest > 0.0 ? strongest : amplitude}, {"line_order", order}});
  if (Find(p, "line_2"))
    plant.Say("torsional_resonance: the bench runs the strongest of the shaft's lines across it");
}

}  // namespace

void MapVibration(Parameters nominal, std::span<const NamedCause> causes, const MappingContext& context,
                  PlantTerms& plant) {
  plant.Off({"vibration_tooth_mesh", "vibration_resonances"});
  const double relative = RelativeSpeed(context);
  // The shaft's lines rise with the speed squared.
  const double square = relative * relative;
  plant.Set("vibration_orders", {{"input_4_m_per_s2", 0.0}});
  if (const auto first = MeanOf(nominal, "first_amplitude_")) {
    plant.Set("vibration_orders", {{"input_1_m_per_s2", *first / square}});
  }
  if (const auto second = MeanOf(nominal, "second_amplitude_")) {
    plant.Set("vibration_orders", {{"input_2_m_per_s2", *second / square}});
  }
  for (const NamedCause& cause : causes) {
    if (Find(cause.parameters, "amplitude") || Find(cause.parameters, "amplitude_at_1000_rpm")) {
      plant.Say(fmt::format("{}: the record's channels are no accelerations, which the bench has alone",
                            cause.name));
    } else if (cause.name == "gear_mesh") {
      MapMesh(cause, context, plant);
    } else if (cause.name == "bearing_defect") {
      const double order = Require(cause, "defect_order");
      plant.Set("vibration_bearing_defect", {{"order_per_turn", order}});
      MapPassings(cause, "vibration_bearing_defect", order, 2.0, context, plant);
    } else if (cause.name == "imbalance") {
      plant.Set("vibration_imbalance",
                {{"amplitude_m_per_s2", Require(cause, "amplitude_at_1000_rpm_m_per_s2")},
                 {"phase_rad", SinePhase_rad(Find(cause.parameters, "phase_deg").value_or(90.0))},
                 {"reference_speed_rad_per_s", RadPerSFromRpm(1000.0)}});
    } else if (cause.name == "flexspline_crack") {
      plant.Set("vibration_flexspline_crack", {{"harmonic_share", 0.0}});
      MapPassings(cause, "vibration_flexspline_crack", Require(cause, "crack_order"), 1.0 / context.ratio,
                  context, plant);
    } else if (cause.name == "torsional_resonance") {
      MapMode(cause, context, plant);
    } else {
      SayUnknown(cause, plant);
    }
  }
}

}  // namespace strainwave::bench::mapping
