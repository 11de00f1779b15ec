// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/diagnosis_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/diagnosis/extended_model.h"
#include "bench/diagnosis/residual_views.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using diagnosis::CauseRule;
using diagnosis::ParameterValue;

constexpr std::size_t kLineWidth = 110;
constexpr std::size_t kCandidatesShown = 12;
constexpr double kCloseToNoise = 1.2;

std::string WhereWords(diagnosis::Where where) {
  switch (where) {
    case diagnosis::Where::kBench:
      return "in the bench";
    case diagnosis::Where::kUnit:
      return "in the unit";
    case diagnosis::Where::kUndecided:
      return "in the bench or in the unit, which these records cannot tell";
  }
  return {};
}

// Words in lines of at most kLineWidth, the first one behind `head`.
std::string Wrapped(const std::string& head, const std::string& words, std::size_t indent) {
  std::string text;
  std::string line = head;
  std::size_t at = 0;
  while (at < words.size()) {
    const std::size_t end = std::min(words.find(' ', at), words.size());
    const std::string word = words.substr(at, end - at);
    if (line.size() + word.size() + 1 > kLineWidth && line.size() > indent) {
      text += line + "\n";
      line = std::string(indent, ' ') + word;
    } else {
      line += line.empty() || line.back() == ' ' ? word : " " + word;
    }
    at = end + 1;
  }
  return text + line + "\n";
}

// A section's name stands in a column of its own.
std::string Section(std::string_view name, const std::string& words) {
  return Wrapped(fmt::format("{:<13}", name), words, 13);
}

std::string ValueText(const ParameterValue& parameter) {
  const std::string unit = parameter.unit == "1" ? "" : parameter.unit;
  std::string text = EstimateText({parameter.value, parameter.standard_error}, unit);
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

std::string ParametersText(const std::vector<ParameterValue>& parameters,
                           const std::vector<ParameterValue>& before) {
  std::string text;
  for (const ParameterValue& parameter : parameters) {
    text += fmt::format("             {:<36} {}", parameter.name, ValueText(parameter));
    const auto earlier = std::ranges::find(before, parameter.name, &ParameterValue::name);
    if (earlier != before.end()) text += fmt::format("   (before: {:.4g})", earlier->value);
    text += "\n";
  }
  return text;
}

std::string MeasuredText(const DiagnosisReport& report) {
  std::size_t samples = 0;
  for (const RecordIdentity& record : report.input.records) samples += record.rows;
  const std::size_t records = report.input.records.size();
  std::string text =
      Section("measured",
              report.input.kind == "campaign"
                  ? fmt::format("a campaign of {} cycles", samples)
                  : fmt::format("{} of kind {}, {} samples{}",
                                records == 1 ? std::string("one record") : fmt::format("{} records", records),
                                report.input.kind, samples, records == 1 ? "" : " together"));
  for (const RecordIdentity& record : report.input.records) {
    text += fmt::format("             {}{}  sha256 {}\n", record.file,
                        record.group.empty() ? "" : " " + record.group, record.sha256.substr(0, 12));
  }
  for (const std::string& warning : report.input.warnings) text += Section("  warning", warning);
  for (const std::string& note : report.result.notes) text += Section("  note", note);
  return text;
}

std::string NominalText(const DiagnosisReport& report) {
  const diagnosis::Study& study = *report.input.study;
  std::string text =
      Section("simulation", fmt::format("{}, refitted to the record{}",
                                        report.model.empty() ? "the nominal model of " + report.input.kind
                                                             : "the model " + report.model,
                                        report.input.records.size() == 1 ? "" : "s"));
  const diagnosis::ModelFit& fit = report.result.nominal;
  text += ParametersText(fit.nominal, report.nominal_before);
  for (std::size_t i = 0; i < fit.causes.size(); ++i) {
    text += fmt::format("             {}\n", study.causes()[fit.causes[i]].name);
    text += ParametersText(fit.cause_parameters[i], {});
  }
  return text;
}

std::string FoundText(const DiagnosisReport& report) {
  std::string text;
  for (const diagnosis::Finding& finding : report.result.causes) {
    const CauseRule& rule = report.input.study->causes()[finding.index];
    text += Section("found", fmt::format("{}: {}", rule.name, rule.sentence));
    text += Section("", fmt::format("lies {}; explains {:.0f} % of what the simulation misses beyond noise",
                                    WhereWords(rule.where), 100.0 * finding.share_of_explainable));
    text += ParametersText(finding.parameters, {});
    if (!finding.indistinguishable_from.empty()) {
      text += Section("", fmt::format("these records would be explained as well by: {}",
                                      fmt::join(finding.indistinguishable_from, ", ")));
    }
  }
  for (const diagnosis::Finding& finding : report.result.corrections) {
    const CauseRule& rule = report.input.study->causes()[finding.index];
    text += rule.stated_number
                ? Section("to correct", fmt::format("{}: {}", rule.name, rule.sentence))
                : Section("left over", fmt::format("{} (a description, not a cause)", rule.name));
    text += ParametersText(TellingParameters(finding), {});
  }
  if (!report.formula.formula.empty()) {
    text += Section("formula", report.formula.formula);
    text += Section("", report.formula.sentence);
  }
  return text;
}

// Held-out data are asked only of a candidate that chance does not explain.
std::string HeldOutText(double gain) {
  return gain == 0.0 || !std::isfinite(gain) ? "-" : fmt::format("{:+.1f}", gain);
}

std::string CandidatesText(const DiagnosisReport& report) {
  std::string text =
      fmt::format("{:<13}{:<34} {:>10} {:>8} {:>9}\n", "candidates", "", "ΔBIC", "p", "held out");
  std::size_t shown = 0;
  for (const diagnosis::CandidateResult& candidate : report.result.candidates) {
    if (shown == kCandidatesShown && !candidate.passed) continue;
    ++shown;
    const std::string name = CandidateName(*report.input.study, candidate.index);
    text += fmt::format("  {} {:<44} {:>9.1f} {:>8} {:>9}  {}\n", candidate.passed ? "yes" : " no", name,
                        candidate.evidence.delta_bic, ProbabilityText(candidate.evidence.p_value),
                        HeldOutText(candidate.evidence.heldout_gain),
                        candidate.passed ? "passed" : candidate.objection);
  }
  const std::size_t left = report.result.candidates.size() - shown;
  if (left > 0) text += fmt::format("             and {} more with less evidence\n", left);
  return text;
}

std::string GainText(const DiagnosisReport& report) {
  const diagnosis::Diagnosis& result = report.result;
  const double unit = report.input.study->unit_per_si();
  const std::string& name = report.input.study->unit();
  const std::string noise = result.noise_floor > 0.0
                                ? fmt::format("; noise {:.3g} {}", result.noise_floor * unit, name)
                                : std::string();
  if (result.causes.empty() && result.corrections.empty()) {
    return Section("error", fmt::format("{:.3g} {} on data that no fit has seen{}",
                                        result.nominal_heldout_rmse * unit, name, noise));
  }
  return Section(
      "gain",
      fmt::format("error on data that no fit has seen: {:.3g} -> {:.3g} {}, {:.0f} % less ({:.0f} "
                  "to {:.0f} % with 95 % confidence){}",
                  result.nominal_heldout_rmse * unit, result.extended_heldout_rmse * unit, name,
                  100.0 * result.gain.reduction, 100.0 * result.gain.low, 100.0 * result.gain.high, noise));
}

std::string RemainsText(const DiagnosisReport& report) {
  constexpr double kWhite = 0.01, kMuch = 0.05;
  const diagnosis::Leftover& leftover = report.result.leftover;
  std::string what = leftover.signature;
  if (what.empty()) {
    what = "nothing in it stands out";
    if (leftover.ljung_box_p < kWhite && leftover.share_of_residual_variance > kMuch) {
      what +=
          " but that neighbouring samples are alike: noise that is not white does that, and is more than it "
          "looks from one sample to the next";
    }
  }
  return Section("remains", fmt::format("{:.1f} % of the variance of that error; {}",
                                        100.0 * leftover.share_of_residual_variance, what));
}

std::string QuantitiesText(const DiagnosisReport& report) {
  const auto nominal = report.input.study->Quantities(report.result.nominal.predicted);
  const auto extended = report.input.study->Quantities(report.result.extended.predicted);
  if (nominal.empty()) return {};
  const bool found = !report.result.causes.empty() || !report.result.corrections.empty();
  std::string text = fmt::format("{:<13}{:<28} {:>12} {:>12}{}\n", "quantities", "", "measured",
                                 found ? "without" : "simulated", found ? "         with" : "");
  for (std::size_t i = 0; i < nominal.size() && i < extended.size(); ++i) {
    text += fmt::format("             {:<28} {:>12.5g} {:>12.5g}", nominal[i].name, nominal[i].measured,
                        nominal[i].predicted);
    text += found ? fmt::format(" {:>12.5g}\n", extended[i].predicted) : "\n";
  }
  return text;
}

std::string LooksText(const DiagnosisReport& report) {
  const std::vector<RegressorShare> shares = SharesByRegressor(report);
  if (report.result.verdict == diagnosis::Verdict::kNoEffect || shares.empty()) return {};
  return Section("shows over", fmt::format("{}: {:.0f} % of the variance of the nominal residual follows it",
                                           shares.front().title, 100.0 * shares.front().share));
}

std::string NextText(const DiagnosisReport& report) {
  const std::vector<std::string> entries = MeasurementsToSettle(report);
  if (entries.empty()) {
    if (report.result.verdict != diagnosis::Verdict::kNoEffect)
      return Section("next", "run extended_model.yaml (diagnose --out) in place of the nominal model");
    return report.result.corrections.empty() ? Section("next", "nothing that this diagnosis can name")
                                             : Section("next",
                                                       "put what stands under \"to correct\" into the head "
                                                       "of the record, or look which unit it is of");
  }
  std::string text = Section("next", "measure what these records cannot tell:");
  for (const std::string& entry : entries) {
    std::size_t at = 0;
    while (at < entry.size()) {
      const std::size_t end = std::min(entry.find('\n', at), entry.size());
      text += "             " + entry.substr(at, end - at) + "\n";
      at = end + 1;
    }
  }
  return text;
}

}  // namespace

std::string VerdictSentence(const DiagnosisReport& report) {
  const diagnosis::Diagnosis& result = report.result;
  if (result.verdict == diagnosis::Verdict::kNoEffect) {
    if (!result.corrections.empty()) {
      const CauseRule& rule = report.input.study->causes()[result.corrections.front().index];
      return fmt::format("Nothing is missing in the simulation, but a number of the record is wrong: {}.",
                         rule.sentence);
    }
    const double excess = result.noise_floor > 0.0 ? result.nominal_heldout_rmse / result.noise_floor : 1.0;
    if (excess < kCloseToNoise) {
      return "Nothing is missing in the simulation: it explains these records down to their noise.";
    }
    return fmt::format(
        "Nothing was found missing in the simulation, but it does not explain these records down to their "
        "noise: "
        "its error on unseen data is {:.2g} times that (too few data, or noise that is not white).",
        excess);
  }
  if (result.verdict == diagnosis::Verdict::kUnnamedStructure) {
    const std::string signature = SignatureOf(report);
    return "Something is missing in the simulation that no known cause explains" +
           (signature.empty() ? std::string(".") : ": " + signature + ".");
  }
  std::vector<std::string> names;
  for (const diagnosis::Finding& finding : result.causes) {
    const CauseRule& rule = report.input.study->causes()[finding.index];
    std::string name = rule.name;
    for (const std::string& rival : finding.indistinguishable_from) name += " or " + rival;
    names.push_back(fmt::format(
        "{} ({})", name,
        rule.where == diagnosis::Where::kUndecided ? std::string("bench or unit") : WhereWords(rule.where)));
  }
  return names.size() == 1 ? fmt::format("One effect is missing in the simulation: {}.", names.front())
                           : fmt::format("{} effects are missing in the simulation: {}.", names.size(),
                                         fmt::join(names, ", "));
}

std::string DiagnosisText(const DiagnosisReport& report) {
  return Wrapped("", VerdictSentence(report), 0) + "\n" + MeasuredText(report) + NominalText(report) + "\n" +
         FoundText(report) + LooksText(report) + CandidatesText(report) + "\n" + GainText(report) +
         RemainsText(report) + QuantitiesText(report) + "\n" + NextText(report);
}

std::string FilesText(const std::filesystem::path& model,
                      const std::vector<std::filesystem::path>& pictures) {
  std::string text = fmt::format("\nmodel        {}\n", model.string());
  for (const auto& picture : pictures) {
    text += fmt::format("{:<13}{}.svg (and .png)\n", &picture == &pictures.front() ? "pictures" : "",
                        picture.string());
  }
  return text;
}

}  // namespace strainwave::bench
