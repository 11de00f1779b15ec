// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/specimens_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/ranges.h>

#include "analysis/units.h"
#include "bench/diagnosis/diagnosis_json.h"
#include "bench/diagnosis/diagnosis_text.h"
#include "bench/diagnosis/text_sections.h"
#include "bench/text.h"
#include "daq/software.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using analysis::statistics::RandomEffects;
using diagnosis::Belonging;
using diagnosis::ParameterValue;
using diagnosis::SpecimenComparison;
using diagnosis::SpecimenSize;
using Json = nlohmann::ordered_json;

constexpr char kNoDecision[] =
    "An effect of the bench that changes with each mounting, as the phase of an encoder that was set again, "
    "looks like the units' own; what every unit has by design, as the engagement of teeth, looks like the "
    "bench's.";

// Any specimen's amount: its name and unit are those of all.
const ParameterValue* AmountOf(const SpecimenComparison& comparison) {
  for (const SpecimenSize& size : comparison.sizes)
    if (size.amount) return &*size.amount;
  return nullptr;
}

// The mean as an amount, and its phase.
struct MeanOfSpecimens {
  ParameterValue amount;
  double phase_deg{};
};

MeanOfSpecimens MeanSizeOf(const SpecimenComparison& comparison) {
  const RandomEffects& effects = *comparison.effects;
  MeanOfSpecimens mean{*AmountOf(comparison)};
  if (!comparison.phases) {
    mean.amount.value = effects.mean(0);
    mean.amount.standard_error = std::sqrt(effects.mean_covariance(0, 0));
    return mean;
  }
  mean.amount.value = effects.mean.norm();
  mean.phase_deg = DegFromRad(std::atan2(effects.mean(1), effects.mean(0)));
  const Eigen::VectorXd along = effects.mean / std::max(mean.amount.value, 1e-300);
  mean.amount.standard_error = std::sqrt(along.dot(effects.mean_covariance * along));
  return mean;
}

std::string SizeWords(double value, const std::string& unit) {
  return unit.empty() || unit == "1" ? Text("{:.3g}", value) : Text("{:.3g} {}", value, unit);
}

std::vector<std::string> NamesOf(const SpecimensReport& report, const SpecimenComparison& comparison,
                                 bool (*chosen)(const SpecimenSize&)) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < comparison.sizes.size(); ++i)
    if (chosen(comparison.sizes[i])) names.push_back(report.specimens[i].name);
  return names;
}

std::string Headline(const SpecimensReport& report) {
  const auto count = [&](Belonging belonging) {
    return std::ranges::count(report.comparisons, belonging, &SpecimenComparison::belonging);
  };
  const std::string_view kind = NameOf(report.specimens.front().report.input.kind);
  if (report.comparisons.empty()) {
    return Text("{} specimens, records of kind {}: no cause was found in any of them.",
                report.specimens.size(), kind);
  }
  return Text(
      "{} specimens, records of kind {}: {} shared (with the bench), {} own (to the units), {} "
      "undecided.",
      report.specimens.size(), kind, count(Belonging::kShared), count(Belonging::kOwn),
      count(Belonging::kUndecided));
}

std::string PhaseText(const ParameterValue& phase) {
  return Text("at {:.1f} ± {:.1f} deg", phase.value, phase.standard_error);
}

std::string RowText(const std::string& name, const SpecimenSize& size) {
  const std::string state = size.found ? "found" : size.present() ? "there, not named" : "not there";
  if (!size.amount)
    return Text("             {:<26} {:<28} {:<24} {}", name, "–", "", size.found ? "found" : "not known");
  return Text("             {:<26} {:<28} {:<24} {}", name, ValueText(*size.amount),
              size.phase ? PhaseText(*size.phase) : "", state);
}

std::string SizesText(const SpecimensReport& report, const SpecimenComparison& comparison) {
  std::string text;
  for (std::size_t i = 0; i < comparison.sizes.size(); ++i)
    text += RowText(report.specimens[i].name, comparison.sizes[i]) + "\n";
  if (!comparison.effects) return text;
  const MeanOfSpecimens mean = MeanSizeOf(comparison);
  const RandomEffects& effects = *comparison.effects;
  text +=
      Text("             {:<26} {:<28} {:<24} p {}\n", "mean", ValueText(mean.amount),
           comparison.phases ? Text("at {:.1f} deg", mean.phase_deg) : "", ProbabilityText(effects.mean_p));
  return text + Text("             {:<26} {:<28} {:<24} all alike: p {}\n", "between specimens",
                     SizeWords(effects.tau, mean.amount.unit),
                     Text("(95 %: {:.2g} to {:.2g})", effects.tau_low, effects.tau_high),
                     ProbabilityText(effects.homogeneity_p));
}

Json SizeJson(const std::string& name, const SpecimenSize& size) {
  const auto number = [](const std::optional<ParameterValue>& value, double ParameterValue::*member) {
    return value ? Json((*value).*member) : Json(nullptr);
  };
  return {{"specimen", name},
          {"found", size.found},
          {"present", size.amount ? Json(size.present()) : Json(nullptr)},
          {"value", number(size.amount, &ParameterValue::value)},
          {"se", number(size.amount, &ParameterValue::standard_error)},
          {"phase_deg", number(size.phase, &ParameterValue::value)},
          {"phase_se_deg", number(size.phase, &ParameterValue::standard_error)},
          {"zero_p", size.amount ? Json(size.zero_p) : Json(nullptr)}};
}

Json ComparisonJson(const SpecimensReport& report, const SpecimenComparison& comparison) {
  const ParameterValue* const amount = AmountOf(comparison);
  Json sizes = Json::array();
  for (std::size_t i = 0; i < comparison.sizes.size(); ++i)
    sizes.push_back(SizeJson(report.specimens[i].name, comparison.sizes[i]));
  Json json{
      {"name", comparison.name},
      {"verdict", BelongingText(comparison.belonging)},
      {"sentence", BelongingSentence(report, comparison)},
      {"parameter", amount ? Json(amount->name) : Json(nullptr)},
      {"unit", amount ? Json(amount->unit) : Json(nullptr)},
      {"with_phase", comparison.phases},
      {"specimens", std::move(sizes)},
      {"mean", nullptr},
      {"between", nullptr},
      {"homogeneity", nullptr},
      {"specimens_needed", comparison.specimens_needed ? Json(*comparison.specimens_needed) : Json(nullptr)}};
  if (!comparison.effects) return json;
  const RandomEffects& effects = *comparison.effects;
  const MeanOfSpecimens mean = MeanSizeOf(comparison);
  json["mean"] = {{"value", mean.amount.value},
                  {"se", mean.amount.standard_error},
                  {"phase_deg", comparison.phases ? Json(mean.phase_deg) : Json(nullptr)},
                  {"p_value", effects.mean_p}};
  json["between"] = {{"sd", effects.tau},
                     {"low", effects.tau_low},
                     {"high", effects.tau_high},
                     {"sd_of_moments", effects.tau_of_moments}};
  json["homogeneity"] = {{"q", effects.q},
                         {"degrees_of_freedom", effects.degrees_of_freedom},
                         {"p_value", effects.homogeneity_p}};
  return json;
}

std::string OwnSentence(const SpecimensReport& report, const SpecimenComparison& comparison,
                        const std::string& spread, const std::string& mean) {
  const std::vector<std::string> without =
      NamesOf(report, comparison, [](const SpecimenSize& size) { return size.amount && !size.present(); });
  if (without.empty()) {
    return Text(
        "belongs to the units: all {} specimens have it, each in its own {}; they differ by {} where "
        "the mean is {}",
        comparison.known(), comparison.phases ? "size or phase" : "size", spread, mean);
  }
  const std::vector<std::string> with =
      NamesOf(report, comparison, [](const SpecimenSize& size) { return size.amount && size.present(); });
  return Text("belongs to the units: {} {} it, {} {} not; they differ by {}", fmt::join(with, ", "),
              with.size() == 1 ? "has" : "have", fmt::join(without, ", "),
              without.size() == 1 ? "does" : "do", spread);
}

}  // namespace

bool PhasesHaveOneZero(StudyKind kind) { return kind != StudyKind::kVibration; }

std::string BelongingText(Belonging belonging) {
  switch (belonging) {
    case Belonging::kShared:
      return "shared";
    case Belonging::kOwn:
      return "own";
    case Belonging::kUndecided:
      return "undecided";
  }
  return {};
}

std::string BelongingSentence(const SpecimensReport& report, const SpecimenComparison& comparison) {
  if (!comparison.effects) {
    return Text("undecided: its size is known of {} of {} specimens", comparison.known(),
                comparison.sizes.size());
  }
  const RandomEffects& effects = *comparison.effects;
  const ParameterValue mean_amount = MeanSizeOf(comparison).amount;
  const std::string mean = SizeWords(mean_amount.value, mean_amount.unit);
  const std::string bounds =
      Text("{:.3g} to {}", effects.tau_low, SizeWords(effects.tau_high, mean_amount.unit));
  if (comparison.belonging == Belonging::kShared) {
    return Text(
        "comes with the bench: all {} specimens have it, and they differ by at most {} (95 %) where "
        "the mean is {}",
        comparison.known(), SizeWords(effects.tau_high, mean_amount.unit), mean);
  }
  if (comparison.belonging == Belonging::kOwn)
    return OwnSentence(report, comparison, bounds + " (95 %)", mean);
  std::string more = "more specimens like these would not decide it";
  if (comparison.specimens_needed)
    more = Text("about {} specimens like these would decide it", *comparison.specimens_needed);
  return Text("undecided: {} of {} specimens have it; they may differ by {} (95 %) where the mean is {}; {}",
              comparison.present(), comparison.known(), bounds, mean, more);
}

std::string SpecimensText(const SpecimensReport& report) {
  std::string text = Wrapped("", Headline(report), 0) + "\n";
  for (const DiagnosedSpecimenReport& specimen : report.specimens)
    text += Section(specimen.name, VerdictSentence(specimen.report));
  for (const SpecimenComparison& comparison : report.comparisons) {
    const ParameterValue* const amount = AmountOf(comparison);
    text += Text("\n{}: {}{}\n", comparison.name, BelongingText(comparison.belonging),
                 amount ? " (" + amount->name + ")" : "");
    text += Section("", BelongingSentence(report, comparison)) + SizesText(report, comparison);
  }
  if (!report.comparisons.empty()) text += "\n" + Wrapped("", kNoDecision, 0);
  return text;
}

Json SpecimensJson(const SpecimensReport& report) {
  Json specimens = Json::array();
  for (const DiagnosedSpecimenReport& specimen : report.specimens) {
    specimens.push_back({{"specimen", specimen.name},
                         {"folder", specimen.folder},
                         {"diagnosis", DiagnosisJson(specimen.report)}});
  }
  Json shared = Json::array();
  for (const SpecimenComparison& comparison : report.comparisons)
    shared.push_back(ComparisonJson(report, comparison));
  return {{"kind", NameOf(report.specimens.front().report.input.kind)},
          {"specimens", std::move(specimens)},
          {"shared", std::move(shared)},
          {"software", daq::Software()}};
}

}  // namespace strainwave::bench
