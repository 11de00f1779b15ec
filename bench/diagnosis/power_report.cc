// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/power_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include <fmt/ranges.h>

#include "bench/text.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using diagnosis::CausePower;
using diagnosis::CauseRule;
using diagnosis::DetectedFrom;
using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestReason = 150;

// The closed list of docs/contract.md.
std::vector<std::string_view> CausesOfKind(StudyKind kind) {
  switch (kind) {
    case StudyKind::kTransmissionError:
      return {"wave_generator_first_harmonic",
              "wave_generator_fourth_harmonic",
              "output_eccentricity",
              "circular_spline_ovality",
              "backlash",
              "thermal_drift",
              "local_tooth_damage",
              "load_windup"};
    case StudyKind::kHysteresis:
      return {"backlash",      "asymmetric_stiffness", "cubic_hardening",      "creep",          "brake_slip",
              "thermal_drift", "torque_zero_offset",   "distributed_friction", "rate_dependence"};
    case StudyKind::kMotion:
      return {"stribeck_friction",
              "asymmetric_friction",
              "position_periodic_torque",
              "gravity_load",
              "quadratic_drag",
              "load_dependent_friction",
              "thermal_friction_drift",
              "torsional_resonance",
              "backlash",
              "time_delay",
              "external_disturbance"};
    case StudyKind::kVibration:
      return {"gear_mesh", "bearing_defect", "imbalance", "torsional_resonance", "flexspline_crack"};
    case StudyKind::kCampaign:
      return {"step_change", "slope_change", "daily_temperature"};
  }
  return {};
}

std::string UnitText(const std::string& unit) { return unit.empty() || unit == "1" ? "" : " " + unit; }

// "0.8 to 1.1"; without an upper end "0.8 and up".
std::string IntervalText(const DetectedFrom& from) {
  return std::isfinite(from.high) ? Text("{:.2g} to {:.2g}", from.low, from.high)
                                  : Text("{:.2g} and up", from.low);
}

// What it is, without what usually makes it.
std::string WhatItIs(const CauseRule& rule) {
  return rule.sentence.substr(0, rule.sentence.find_first_of(":;"));
}

std::string SizesInWords(const DiagnosisReport& report) {
  std::string text;
  for (const CausePower& power : report.power->causes) {
    if (!power.size) continue;
    const diagnosis::ParameterValue size{power.amount, power.unit, power.size->value, 0.0};
    text += Text("             - {}: {} or more\n", WhatItIs(report.input.study->causes()[power.cause]),
                 SpokenParameter(size));
  }
  return text;
}

std::string OthersText(const std::vector<diagnosis::PlantedOutcome>& trials) {
  std::map<std::string, int> times;
  for (const diagnosis::PlantedOutcome& trial : trials)
    for (const std::string& name : trial.others) ++times[name];
  std::vector<std::string> words;
  for (const auto& [name, count] : times) words.push_back(Text("{} {}", count, name));
  return fmt::format("{}", fmt::join(words, ", "));
}

Json OthersJson(const std::vector<diagnosis::PlantedOutcome>& trials) {
  std::map<std::string, int> times;
  for (const diagnosis::PlantedOutcome& trial : trials)
    for (const std::string& name : trial.others) ++times[name];
  return Json(times);
}

std::string TableText(const DiagnosisReport& report) {
  std::string text =
      Text("             {:<46} {:>10} {:<30} {:>6} {:<14} {:>9}  {}\n", "found nine times of ten from", "",
           "(95 %)", "sigma", "(95 %)", "found", "other names");
  for (const CausePower& power : report.power->causes) {
    if (!power.size) continue;
    const double sigma = power.sigma ? power.sigma->value : NAN;
    std::string line = Text("             {:<46} {:>10.3g} {:<30} {:>6.2g} {:<14} {:>9}  {}",
                            CandidateName(*report.input.study, power.cause), power.size->value,
                            IntervalText(*power.size) + UnitText(power.unit), sigma,
                            power.sigma ? IntervalText(*power.sigma) : "",
                            Text("{} of {}", power.found(), power.trials.size()), OthersText(power.trials));
    line.resize(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string Shortened(std::string words) {
  if (words.size() > kLongestReason) words.resize(kLongestReason);
  return words;
}

std::string NeverText(const DiagnosisReport& report) {
  std::string text;
  for (const CausePower& power : report.power->causes) {
    if (power.size) continue;
    double largest = 0.0;
    for (const diagnosis::PlantedOutcome& trial : power.trials) largest = std::max(largest, trial.amount);
    text += Text("             {}: never so often", CandidateName(*report.input.study, power.cause));
    if (largest > 0.0) {
      text += Text(", {} of {} found up to {}", power.found(), power.trials.size(),
                   SpokenParameter({power.amount, power.unit, largest, 0.0}));
    }
    text += power.objection.empty() ? "\n" : Text(" ({})\n", Shortened(power.objection));
  }
  const std::vector<std::string> not_shown = CausesNotShown(report);
  if (!not_shown.empty())
    text += Text("             not shown by these records at any size: {}\n", fmt::join(not_shown, ", "));
  return text;
}

Json FromJson(const std::optional<DetectedFrom>& from) {
  if (!from) return nullptr;
  return {{"value", from->value},
          {"low", from->low},
          {"high", std::isfinite(from->high) ? Json(from->high) : Json(nullptr)}};
}

}  // namespace

std::vector<std::string> CausesNotShown(const DiagnosisReport& report) {
  const std::vector<CauseRule>& rules = report.input.study->causes();
  std::vector<std::string> names;
  for (const std::string_view name : CausesOfKind(report.input.kind)) {
    const bool there = std::ranges::find(rules, name, &CauseRule::name) != rules.end();
    if (!there) names.emplace_back(name);
  }
  for (const std::string& name : report.power->cannot_be_drawn)
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  return names;
}

std::string PowerText(const DiagnosisReport& report, const std::string& duration) {
  if (!report.power) return {};
  const diagnosis::DetectionPower& power = *report.power;
  if (!power.refusal.empty()) return Text("\npower        not measured: {}\n", power.refusal);
  const std::string plain = SizesInWords(report);
  std::string text =
      plain.empty()
          ? Text("\npower        no effect of any size would have been found here nine times of ten")
          : Text("\npower        what would have been found here nine times of ten");
  text += Text(" ({} records with planted effects searched in {}):\n", power.searches, duration);
  text += plain;
  if (!plain.empty()) text += "\n" + TableText(report);
  text += NeverText(report);
  const std::size_t named = power.without_with_others();
  text +=
      Text("             without a planted effect: {} of {} records got a name that they do not have{}{}\n",
           named, power.without.size(), named > 0 ? ": " : "", OthersText(power.without));
  return text;
}

Json PowerJson(const DiagnosisReport& report) {
  const diagnosis::DetectionPower& power = *report.power;
  if (!power.refusal.empty())
    return {{"probability", diagnosis::kDetectionProbability}, {"refusal", power.refusal}};
  Json causes = Json::array();
  for (const CausePower& one : power.causes) {
    Json trials = Json::array();
    for (const diagnosis::PlantedOutcome& trial : one.trials)
      trials.push_back({{"size", trial.amount},
                        {"sigma", std::isfinite(trial.sigma) ? Json(trial.sigma) : Json(nullptr)},
                        {"found", trial.found},
                        {"other_names", trial.others}});
    causes.push_back({{"name", report.input.study->causes()[one.cause].name},
                      {"parameter", one.amount},
                      {"unit", one.unit},
                      {"size", FromJson(one.size)},
                      {"sigma", FromJson(one.sigma)},
                      {"objection", one.objection},
                      {"found", one.found()},
                      {"with_other_names", one.with_others()},
                      {"other_names", OthersJson(one.trials)},
                      {"trials", std::move(trials)}});
  }
  return {{"probability", diagnosis::kDetectionProbability},
          {"records_searched", power.searches},
          {"causes", std::move(causes)},
          {"not_shown", CausesNotShown(report)},
          {"without_effect",
           {{"records", power.without.size()},
            {"with_other_names", power.without_with_others()},
            {"other_names", OthersJson(power.without)}}}};
}

}  // namespace strainwave::bench
