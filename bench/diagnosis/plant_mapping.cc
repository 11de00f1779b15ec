// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/plant_mapping.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/diagnosis/plant_mapping_parts.h"

namespace strainwave::bench {
namespace mapping {

std::optional<double> Find(Parameters parameters, std::string_view name) {
  const auto found = std::ranges::find(parameters, name, &analysis::diagnosis::ParameterValue::name);
  if (found == parameters.end()) return std::nullopt;
  return found->value;
}

double Require(const NamedCause& cause, std::string_view name) {
  const std::optional<double> value = Find(cause.parameters, name);
  if (!value) throw std::invalid_argument(fmt::format("{} has no parameter {}", cause.name, name));
  return *value;
}

double SinePhase_rad(double phase_deg) { return 0.5 * kPi - RadFromDeg(phase_deg); }

TermDescription& PlantTerms::Named(std::string_view term) {
  const auto found = std::ranges::find(mapping_.terms, term, &TermDescription::name);
  if (found != mapping_.terms.end()) return *found;
  mapping_.terms.push_back({std::string(term), true, {}, 0});
  return mapping_.terms.back();
}

void PlantTerms::Set(std::string_view term,
                     std::initializer_list<std::pair<std::string_view, double>> parameters) {
  TermDescription& named = Named(term);
  named.enabled = true;
  for (const auto& [name, value] : parameters) {
    const auto found = std::ranges::find(named.parameters, name, &std::pair<std::string, double>::first);
    if (found == named.parameters.end()) {
      named.parameters.emplace_back(name, value);
    } else {
      found->second = value;
    }
  }
}

void PlantTerms::Off(std::initializer_list<std::string_view> terms) {
  for (const std::string_view term : terms) Named(term).enabled = false;
}

void SayUnknown(const NamedCause& cause, PlantTerms& plant) {
  plant.Say(fmt::format("{}: the simulated bench has no term for it", cause.name));
}

}  // namespace mapping

PlantMapping PlantTermsOf(StudyKind kind, mapping::Parameters nominal,
                          std::span<const mapping::NamedCause> causes, const MappingContext& context) {
  mapping::PlantTerms plant;
  if (kind == StudyKind::kCampaign) {
    plant.Say("campaign: the wear of the simulated gear follows laws of its own, not the fitted trends");
    return plant.Take();
  }
  if (kind == StudyKind::kMotion && mapping::Find(nominal, "mass_kg")) {
    plant.Say("motion: a linear axis has no place on the simulated bench, which turns");
    return plant.Take();
  }
  // What was fitted is one specimen, not the mean of many.
  plant.Off({"specimen_scatter"});
  if (kind == StudyKind::kTransmissionError) mapping::MapTransmissionError(nominal, causes, context, plant);
  if (kind == StudyKind::kHysteresis) mapping::MapHysteresis(nominal, causes, context, plant);
  if (kind == StudyKind::kMotion) mapping::MapMotion(nominal, causes, context, plant);
  if (kind == StudyKind::kVibration) mapping::MapVibration(nominal, causes, context, plant);
  return plant.Take();
}

}  // namespace strainwave::bench
