// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/diagnosis_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/ranges.h>

#include "bench/diagnosis/extended_model.h"
#include "bench/diagnosis/parameter_words.h"
#include "bench/diagnosis/plain_words.h"
#include "bench/diagnosis/residual_views.h"
#include "bench/diagnosis/text_sections.h"
#include "bench/diagnosis/trust_report.h"
#include "bench/text.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using diagnosis::CauseRule;
using diagnosis::ParameterValue;

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

// Of a share: what is there never reads as nothing.
std::string PercentText(double share) {
  const double percent = 100.0 * share;
  return std::abs(percent) < 9.95 ? Text("{:.2g}", percent) : Text("{:.0f}", percent);
}

// Name, value with error, a remark beside it, and what it is.
std::string ParameterLine(const ParameterValue& parameter, const std::string& remark) {
  std::string line = Text("             {:<36} {:<28} {:<22} {}", parameter.name, ValueText(parameter),
                          remark, ParameterWords(parameter.name));
  line.resize(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

// Without details, long lists are left out with a word.
std::string ParametersText(const std::vector<ParameterValue>& parameters, bool details) {
  std::string text;
  std::size_t left_out = 0;
  for (const ParameterValue& parameter : parameters) {
    if (details || !IsDetail(parameter.name)) {
      text += ParameterLine(parameter, "");
    } else {
      ++left_out;
    }
  }
  if (left_out > 0)
    text += Text("             and {} numbers of its lines and channels (--details)\n", left_out);
  return text;
}

const ParameterValue* Find(const std::vector<ParameterValue>& values, std::string_view name) {
  const auto found = std::ranges::find(values, name, &ParameterValue::name);
  return found == values.end() ? nullptr : &*found;
}

std::string MeasuredText(const DiagnosisReport& report) {
  std::size_t samples = 0;
  for (const RecordIdentity& record : report.input.records) samples += record.rows;
  const std::size_t records = report.input.records.size();
  std::string text =
      Section("measured", report.input.kind == StudyKind::kCampaign
                              ? Text("a campaign of {} cycles", samples)
                              : Text("{} of kind {}, {} samples{}",
                                     records == 1 ? std::string("one record") : Text("{} records", records),
                                     NameOf(report.input.kind), samples, records == 1 ? "" : " together"));
  for (const RecordIdentity& record : report.input.records) {
    text += Text("             {}{}  sha256 {}\n", record.file,
                 record.group.empty() ? "" : " " + record.group, record.sha256.substr(0, 12));
  }
  for (const std::string& warning : report.input.WarningTexts()) text += Section("  warning", warning);
  for (const std::string& note : report.result.notes) text += Section("  note", note);
  return text;
}

std::string NominalText(const DiagnosisReport& report, bool details) {
  const diagnosis::Study& study = *report.input.study;
  std::string text =
      Section("simulation",
              Text("{}, refitted to the record{}",
                   report.model.empty() ? "the nominal model of " + std::string(NameOf(report.input.kind))
                                        : "the model " + report.model,
                   report.input.records.size() == 1 ? "" : "s"));
  const diagnosis::ModelFit& fit = report.result.nominal;
  for (const ParameterValue& parameter : fit.nominal) {
    const ParameterValue* const before = Find(report.nominal_before, parameter.name);
    text += ParameterLine(parameter, before == nullptr ? "" : Text("(before: {:.4g})", before->value));
  }
  for (std::size_t i = 0; i < fit.causes.size(); ++i) {
    text += Text("             {}\n", study.causes()[fit.causes[i]].name);
    text += ParametersText(fit.cause_parameters[i], details);
  }
  return text;
}

// What the simulation's numbers are when what was found is in it.
std::string CorrectedText(const DiagnosisReport& report) {
  const diagnosis::Diagnosis& result = report.result;
  if (result.causes.empty() && result.nuisance_terms.empty()) return {};
  std::string text = Section("corrected", "the simulation's numbers with what was found:");
  for (const ParameterValue& parameter : result.extended.nominal) {
    const ParameterValue* const without = Find(result.nominal.nominal, parameter.name);
    // What is left open has one value of many.
    const bool known = without != nullptr && std::isfinite(without->standard_error);
    text += ParameterLine(parameter, known ? Text("(without: {:.5g})", without->value) : "");
  }
  return text;
}

std::string FoundText(const DiagnosisReport& report, bool details) {
  std::string text;
  for (const diagnosis::Finding* const cause : LargestFirst(report.result.causes)) {
    const diagnosis::Finding& finding = *cause;
    const CauseRule& rule = report.input.study->causes()[finding.index];
    text += Section("found", Text("{}: {}", rule.name, rule.sentence));
    text += Section("", Text("lies {}; explains {} % of what the simulation misses beyond noise",
                             WhereWords(rule.where), PercentText(finding.share_of_explainable)));
    text += ParametersText(finding.parameters, details);
    if (finding.simulated.simulated > 0) {
      text += Section("", Text("of {} records simulated without it, {} show as much",
                               finding.simulated.simulated, finding.simulated.as_strong));
    }
    if (!finding.indistinguishable_from.empty()) {
      text += Section("", Text("these records would be explained as well by: {}",
                               fmt::join(finding.indistinguishable_from, ", ")));
    }
  }
  for (const diagnosis::Finding& finding : report.result.nuisance_terms) {
    const CauseRule& rule = report.input.study->causes()[finding.index];
    text += rule.stated_number ? Section("to correct", Text("{}: {}", rule.name, rule.sentence))
                               : Section("left over", Text("{} (a description, not a cause)", rule.name));
    text += ParametersText(TellingParameters(finding), details);
  }
  if (!report.formula.formula.empty()) {
    text += Section("formula", report.formula.formula);
    text += Section("", report.formula.sentence);
  }
  return text;
}

// Held-out data are asked only of a candidate that chance does not explain.
std::string HeldOutText(double gain) {
  return gain == 0.0 || !std::isfinite(gain) ? "-" : Text("{:+.1f}", gain);
}

std::string CandidatesText(const DiagnosisReport& report) {
  std::string text = Text("{:<13}{:<34} {:>10} {:>8} {:>9}\n", "candidates", "", "ΔBIC", "p", "held out");
  std::size_t shown = 0;
  for (const diagnosis::CandidateResult& candidate : report.result.candidates) {
    if (shown == kCandidatesShown && !candidate.passed) continue;
    ++shown;
    const std::string name = CandidateName(*report.input.study, candidate.index);
    text +=
        Text("  {} {:<44} {:>9.1f} {:>8} {:>9}  {}\n", candidate.passed ? "yes" : " no", name,
             candidate.evidence.delta_bic, ProbabilityText(candidate.evidence.p_value),
             HeldOutText(candidate.evidence.heldout_gain), candidate.passed ? "passed" : candidate.objection);
  }
  const std::size_t left = report.result.candidates.size() - shown;
  if (left > 0) text += Text("             and {} more with less evidence\n", left);
  return text;
}

std::string GainText(const DiagnosisReport& report) {
  const diagnosis::Diagnosis& result = report.result;
  const double unit = report.input.study->unit_per_si();
  const std::string& name = report.input.study->unit();
  const std::string noise =
      result.noise_floor > 0.0 ? Text("; noise {:.3g} {}", result.noise_floor * unit, name) : std::string();
  if (result.causes.empty() && result.nuisance_terms.empty()) {
    return Section("error", Text("{:.3g} {} on data that no fit has seen{}",
                                 result.nominal_heldout_rmse * unit, name, noise));
  }
  return Section("gain", Text("error on data that no fit has seen: {:.3g} -> {:.3g} {}, {} % less ({} "
                              "to {} % with 95 % confidence){}",
                              result.nominal_heldout_rmse * unit, result.extended_heldout_rmse * unit, name,
                              PercentText(result.gain.reduction), PercentText(result.gain.low),
                              PercentText(result.gain.high), noise));
}

std::string RemainsText(const DiagnosisReport& report) {
  constexpr double kWhite = 0.01, kMuch = 0.05;
  const diagnosis::Unexplained& residual = report.result.residual;
  std::string what = residual.signature;
  if (what.empty()) {
    what = "nothing in it stands out";
    if (residual.ljung_box_p < kWhite && residual.share_of_residual_variance > kMuch) {
      what +=
          " but that neighbouring samples are alike: noise that is not white does that, and is more than it "
          "looks from one sample to the next";
    }
  }
  return Section("remains", Text("{:.1f} % of the variance of that error; {}",
                                 100.0 * residual.share_of_residual_variance, what));
}

std::string QuantitiesText(const DiagnosisReport& report) {
  const auto nominal = report.input.study->Quantities(report.result.nominal.predicted);
  const auto extended = report.input.study->Quantities(report.result.extended.predicted);
  if (nominal.empty()) return {};
  const bool found = !report.result.causes.empty() || !report.result.nuisance_terms.empty();
  std::string text = Text("{:<13}{:<28} {:>12} {:>12}{}\n", "quantities", "", "measured",
                          found ? "without" : "simulated", found ? "         with" : "");
  for (std::size_t i = 0; i < nominal.size() && i < extended.size(); ++i) {
    text += Text("             {:<28} {:>12.5g} {:>12.5g}", nominal[i].name, nominal[i].measured,
                 nominal[i].predicted);
    text += found ? Text(" {:>12.5g}\n", extended[i].predicted) : "\n";
  }
  return text;
}

std::string LooksText(const DiagnosisReport& report) {
  const std::vector<RegressorShare> shares = SharesByRegressor(report);
  if (report.result.verdict == diagnosis::Verdict::kNoEffect || shares.empty()) return {};
  return Section("shows over", Text("{}: {:.0f} % of the variance of the nominal residual follows it",
                                    shares.front().title, 100.0 * shares.front().share));
}

std::string TrustText(const DiagnosisReport& report) {
  const std::string noise =
      Text("; noise {:.3g} {}", report.result.trusted.noise * report.input.study->unit_per_si(),
           report.input.study->unit());
  const std::string as_it_is = TrustWords(report, false);
  if (report.result.causes.empty()) return Section("trusted", as_it_is + noise);
  return Section("trusted", "as it is: " + as_it_is + noise) +
         Section("", "with what was found: " + TrustWords(report, true));
}

std::string PlainText(const DiagnosisReport& report) {
  const PlainWords words = PlainWordsOf(report);
  std::string text;
  if (!words.what_is_missing.empty())
    text += Wrapped("What the simulation lacks:", words.what_is_missing + ".", 0);
  text += Wrapped("How sure:", words.how_sure + ".", 0);
  return text + Wrapped("What to do:", words.what_to_do + ".", 0);
}

std::string NextText(const DiagnosisReport& report) {
  const std::vector<std::string> entries = MeasurementsToSettle(report);
  if (entries.empty()) {
    if (report.result.verdict != diagnosis::Verdict::kNoEffect)
      return Section("next", "run extended_model.yaml (diagnose --out) in place of the nominal model");
    return report.result.nuisance_terms.empty()
               ? Section("next", "nothing that this diagnosis can name")
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
    if (!result.nuisance_terms.empty()) {
      const CauseRule& rule = report.input.study->causes()[result.nuisance_terms.front().index];
      return Text("Nothing is missing in the simulation, but a number of the record is wrong: {}.",
                  rule.sentence);
    }
    const double excess = result.noise_floor > 0.0 ? result.nominal_heldout_rmse / result.noise_floor : 1.0;
    if (excess < kCloseToNoise) {
      return "Nothing is missing in the simulation: it explains these records down to their noise.";
    }
    return Text(
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
  for (const diagnosis::Finding* const cause : LargestFirst(result.causes)) {
    const diagnosis::Finding& finding = *cause;
    const CauseRule& rule = report.input.study->causes()[finding.index];
    std::string name = rule.name;
    for (const std::string& rival : finding.indistinguishable_from) name += " or " + rival;
    names.push_back(Text(
        "{} ({})", name,
        rule.where == diagnosis::Where::kUndecided ? std::string("bench or unit") : WhereWords(rule.where)));
  }
  return names.size() == 1
             ? Text("One effect is missing in the simulation: {}.", names.front())
             : Text("{} effects are missing in the simulation: {}.", names.size(), fmt::join(names, ", "));
}

std::string DiagnosisText(const DiagnosisReport& report, bool details) {
  return PlainText(report) + Wrapped("", VerdictSentence(report), 0) + "\n" + MeasuredText(report) +
         NominalText(report, details) + "\n" + FoundText(report, details) + CorrectedText(report) +
         LooksText(report) + CandidatesText(report) + "\n" + GainText(report) + RemainsText(report) +
         TrustText(report) + QuantitiesText(report) + "\n" + NextText(report);
}

std::string FilesText(const std::filesystem::path& model,
                      const std::vector<std::filesystem::path>& pictures) {
  std::string text = Text("\nmodel        {}\n", model.string());
  for (const auto& picture : pictures) {
    text +=
        Text("{:<13}{}.svg (and .png)\n", &picture == &pictures.front() ? "pictures" : "", picture.string());
  }
  return text;
}

}  // namespace strainwave::bench
