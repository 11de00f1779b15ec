// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/diagnosis_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;

// The structure stays or it does not: the first thing to know of what has no name.
std::string AgainOf(StudyKind kind) {
  if (kind == StudyKind::kTransmissionError) {
    return "# the same sweep twice, in half the step: what belongs to the gear comes back at the same angle\n"
           "- kind: transmission_error\n"
           "  input_speed: 300 rpm\n"
           "  step: 0.5 deg\n"
           "  steps: 1440\n"
           "  directions: both\n";
  }
  if (kind == StudyKind::kHysteresis) {
    return "# two loops at another rate, at two lock angles: what belongs to the gear comes back in each\n"
           "- kind: hysteresis\n"
           "  peak_torque: 34 Nm\n"
           "  torque_rate: 1 Nm/s\n"
           "  hold: 10 s\n"
           "  loops: 2\n"
           "  lock_angles: [0 deg, 90 deg]\n";
  }
  if (kind == StudyKind::kCampaign) return {};
  return "# the same turns at another speed and without load: what follows the angle keeps its order, what\n"
         "# follows time or speed does not\n"
         "- kind: measurement_rotation\n"
         "  output_torque: 5 Nm\n"
         "  input_speed: 1200 rpm\n"
         "  turns: 2\n";
}

void AddOnce(const std::string& entry, std::vector<std::string>& entries) {
  if (!entry.empty() && std::ranges::find(entries, entry) == entries.end()) entries.push_back(entry);
}

// The telling numbers of a nuisance term; a window also by its ends.
std::vector<std::string> SpokenNumbers(const diagnosis::Finding& nuisance_term) {
  const std::vector<diagnosis::ParameterValue> parameters = TellingParameters(nuisance_term);
  std::vector<std::string> numbers;
  for (const diagnosis::ParameterValue& parameter : parameters) {
    numbers.push_back(SpokenParameter(parameter));
    if (!parameter.name.starts_with("width_")) continue;
    const std::string centre_name = "centre_" + parameter.name.substr(std::string_view("width_").size());
    const auto centre = std::ranges::find(parameters, centre_name, &diagnosis::ParameterValue::name);
    if (centre == parameters.end()) continue;
    numbers.push_back(fmt::format("from {:.4g} to {:.4g} {}", centre->value - 0.5 * parameter.value,
                                  centre->value + 0.5 * parameter.value, parameter.unit));
  }
  return numbers;
}

}  // namespace

std::string VerdictText(diagnosis::Verdict verdict) {
  switch (verdict) {
    case diagnosis::Verdict::kEffectFound:
      return "effect_found";
    case diagnosis::Verdict::kNoEffect:
      return "no_effect";
    case diagnosis::Verdict::kUnnamedStructure:
      return "unnamed_structure";
  }
  return {};
}

std::string CandidateName(const diagnosis::Study& study, std::size_t index) {
  const diagnosis::CauseRule& rule = study.causes()[index];
  const auto namesakes = std::ranges::count(study.causes(), rule.name, &diagnosis::CauseRule::name);
  std::string name = rule.name;
  if (namesakes > 1 && !rule.parameters.empty()) name += ": " + rule.parameters.front().name;
  return rule.named ? name : "(" + name + ")";
}

std::string ProbabilityText(double p) {
  if (!(p > 1e-99)) return "<1e-99";
  return p >= 0.001 ? fmt::format("{:.3f}", p) : fmt::format("{:.0e}", p);
}

std::vector<diagnosis::ParameterValue> TellingParameters(const diagnosis::Finding& nuisance_term) {
  std::vector<diagnosis::ParameterValue> telling = nuisance_term.parameters;
  std::erase_if(telling,
                [](const auto& parameter) { return parameter.name.starts_with(diagnosis::kCurvePart); });
  return telling;
}

std::string SpokenParameter(const diagnosis::ParameterValue& parameter) {
  std::string words = parameter.name;
  const bool is_order = words.starts_with("order_per_");
  std::string behind = parameter.unit;
  if (is_order) {
    behind = words.substr(std::string_view("order_").size());
    words = "order";
  } else if (const std::string ending = "_" + parameter.unit; words.ends_with(ending)) {
    words.resize(words.size() - ending.size());
  }
  for (std::string* text : {&words, &behind}) std::ranges::replace(*text, '_', ' ');
  const std::string value =
      is_order ? fmt::format("{:.2f}", parameter.value) : fmt::format("{:.3g}", parameter.value);
  return fmt::format("{} {}{}{}", words, value, behind.empty() || behind == "1" ? "" : " ",
                     behind == "1" ? "" : behind);
}

std::string SignatureOf(const DiagnosisReport& report) {
  std::vector<std::string> parts;
  for (const diagnosis::Finding& nuisance_term : report.result.nuisance_terms) {
    const std::vector<std::string> numbers = SpokenNumbers(nuisance_term);
    parts.push_back(fmt::format("{}{}{}", report.input.study->causes()[nuisance_term.index].name,
                                numbers.empty() ? "" : ": ", fmt::join(numbers, ", ")));
  }
  if (!report.result.residual.described.empty()) parts.push_back(report.result.residual.described);
  const std::string& left = report.result.residual.signature;
  if (!left.empty()) parts.push_back(parts.empty() ? left : "besides: " + left);
  return fmt::format("{}", fmt::join(parts, "; "));
}

// A rival is one cause, or a pair ("brake_slip + thermal_drift").
bool IsPartOf(const std::string& rival, const std::string& name) {
  return rival == name || rival.starts_with(name + " + ") || rival.ends_with(" + " + name);
}

std::vector<std::string> MeasurementsToSettle(const DiagnosisReport& report) {
  const std::vector<diagnosis::CauseRule>& rules = report.input.study->causes();
  std::vector<std::string> entries;
  for (const diagnosis::Finding& cause : report.result.causes) {
    const diagnosis::CauseRule& rule = rules[cause.index];
    if (!cause.indistinguishable_from.empty() || rule.where == diagnosis::Where::kUndecided) {
      AddOnce(rule.to_settle, entries);
    }
    for (const std::string& rival : cause.indistinguishable_from) {
      for (const diagnosis::CauseRule& other : rules) {
        if (IsPartOf(rival, other.name)) AddOnce(other.to_settle, entries);
      }
    }
  }
  if (report.result.verdict == diagnosis::Verdict::kUnnamedStructure) {
    AddOnce(AgainOf(report.input.kind), entries);
  }
  return entries;
}

}  // namespace strainwave::bench
