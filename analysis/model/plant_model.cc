// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/plant_model.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "analysis/model/plant_terms.h"

namespace strainwave::analysis::model {
namespace {

template <typename Range>
std::string Known(const Range& named) {
  std::string text;
  for (const auto& one : named) {
    if (!text.empty()) text += ", ";
    text += one.name;
  }
  return text;
}

template <typename Range>
auto& ByName(Range& named, std::string_view what, std::string_view name) {
  const auto found = std::ranges::find_if(named, [&](const auto& one) { return one.name == name; });
  if (found == named.end()) {
    throw std::invalid_argument("unknown " + std::string(what) + " \"" + std::string(name) +
                                "\" (known: " + Known(named) + ")");
  }
  return *found;
}

[[noreturn]] void RejectValue(const std::string& term, const TermParameter& parameter,
                              std::string_view rule) {
  std::ostringstream text;
  text << term << "." << parameter.name << " = " << parameter.value << " must be " << rule;
  throw std::invalid_argument(text.str());
}

void Apply(const Term& term, BoundTerm& bound) {
  const std::string what = "parameter of term \"" + term.name + "\"";
  std::vector<const BoundParameter*> set;
  for (const TermParameter& parameter : term.parameters) {
    const BoundParameter& target = ByName(bound.parameters, what, parameter.name);
    if (std::ranges::find(set, &target) != set.end()) {
      throw std::invalid_argument(what + " given twice: \"" + parameter.name + "\"");
    }
    set.push_back(&target);
    if (!std::isfinite(parameter.value)) RejectValue(term.name, parameter, "finite");
    if (target.divides && !(parameter.value > 0.0)) RejectValue(term.name, parameter, "above zero");
    if (target.not_negative && parameter.value < 0.0) RejectValue(term.name, parameter, "zero or above");
    *target.value = parameter.value;
  }
}

}  // namespace

PlantModel DefaultPlantModel() {
  PlantParameters defaults;
  PlantModel model;
  model.ratio = defaults.ratio;
  for (const BoundTerm& bound : BindTerms(defaults)) {
    Term term;
    term.name = bound.name;
    term.effect = bound.effect;
    for (const BoundParameter& parameter : bound.parameters) {
      term.parameters.push_back({std::string(parameter.name), *parameter.value, std::string(parameter.unit)});
    }
    model.terms.push_back(std::move(term));
  }
  return model;
}

Term& FindTerm(PlantModel& model, std::string_view name) { return ByName(model.terms, "term", name); }

double& FindParameter(PlantModel& model, std::string_view term, std::string_view parameter) {
  Term& found = FindTerm(model, term);
  return ByName(found.parameters, "parameter of term \"" + found.name + "\"", parameter).value;
}

PlantParameters CompilePlantModel(const PlantModel& model) {
  if (!(std::isfinite(model.ratio) && model.ratio > 1.0)) {
    std::ostringstream text;
    text << "ratio = " << model.ratio
         << " must be above 1 (both encoders are counted so that it is positive)";
    throw std::invalid_argument(text.str());
  }
  PlantParameters parameters;
  parameters.ratio = model.ratio;
  std::vector<BoundTerm> bound = BindTerms(parameters);
  std::vector<const BoundTerm*> on;
  for (std::size_t i = 0; i < model.terms.size(); ++i) {
    const Term& term = model.terms[i];
    BoundTerm& target = ByName(bound, "term", term.name);
    const auto same = [&](const Term& other) { return other.name == term.name; };
    if (std::any_of(model.terms.begin(), model.terms.begin() + static_cast<std::ptrdiff_t>(i), same)) {
      throw std::invalid_argument("term given twice: \"" + term.name + "\"");
    }
    Apply(term, target);
    if (term.enabled) on.push_back(&target);
  }
  for (BoundTerm& term : bound) {
    const bool enabled = std::ranges::find(on, &term) != on.end();
    if (term.flag != nullptr) *term.flag = enabled;
    if (enabled) continue;
    for (const BoundParameter& parameter : term.parameters) *parameter.value = parameter.off;
  }
  if (parameters.spring.t1_Nm >= parameters.spring.t2_Nm) {
    std::ostringstream text;
    text << "torsion_spring.t1_Nm = " << parameters.spring.t1_Nm
         << " must be below t2_Nm = " << parameters.spring.t2_Nm;
    throw std::invalid_argument(text.str());
  }
  if (!(std::abs(parameters.deviations.asymmetry_share) < 1.0)) {
    RejectValue("asymmetric_stiffness", {"asymmetry_share", parameters.deviations.asymmetry_share, "1"},
                "between -1 and 1");
  }
  if (parameters.drive_causes.delay_s > kLongestDriveDelay_s) {
    RejectValue("drive_time_delay", {"delay_s", parameters.drive_causes.delay_s, "s"},
                "at most 0.016 (what the simulated bench carries)");
  }
  return parameters;
}

}  // namespace strainwave::analysis::model
