// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/diagnosis/plant_mapping.h"

/// What the mappings of the kinds have in common.
namespace strainwave::bench::mapping {

using Parameters = std::span<const analysis::diagnosis::ParameterValue>;
using NamedCause = analysis::diagnosis::Study::NamedCause;

/// The value, if it is there.
std::optional<double> Find(Parameters parameters, std::string_view name);

/// @throws std::invalid_argument naming the cause and the parameter that is missing.
double Require(const NamedCause& cause, std::string_view name);

/// The phase φ of A sin(x + φ) for A cos(x − phase).
double SinePhase_rad(double phase_deg);

/// Collects terms; each name once.
class PlantTerms {
 public:
  void Set(std::string_view term, std::initializer_list<std::pair<std::string_view, double>> parameters);
  void Off(std::initializer_list<std::string_view> terms);
  void Say(std::string sentence) { mapping_.not_run.push_back(std::move(sentence)); }
  PlantMapping Take() { return std::move(mapping_); }

 private:
  TermDescription& Named(std::string_view term);

  PlantMapping mapping_;
};

void MapTransmissionError(Parameters nominal, std::span<const NamedCause> causes,
                          const MappingContext& context, PlantTerms& plant);
void MapHysteresis(Parameters nominal, std::span<const NamedCause> causes, const MappingContext& context,
                   PlantTerms& plant);
void MapMotion(Parameters nominal, std::span<const NamedCause> causes, const MappingContext& context,
               PlantTerms& plant);
void MapVibration(Parameters nominal, std::span<const NamedCause> causes, const MappingContext& context,
                  PlantTerms& plant);

/// For a cause that no line of a mapping knows.
void SayUnknown(const NamedCause& cause, PlantTerms& plant);

}  // namespace strainwave::bench::mapping
