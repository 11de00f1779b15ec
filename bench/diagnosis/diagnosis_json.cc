// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/diagnosis_json.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/diagnosis/extended_model.h"
#include "bench/diagnosis/plain_words.h"
#include "bench/diagnosis/power_report.h"
#include "bench/diagnosis/trust_report.h"
#include "daq/software.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;
using diagnosis::ParameterValue;
using Json = nlohmann::ordered_json;

// A number where there is one; JSON knows no other.
Json Known(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double Finite(double value, double otherwise = 0.0) { return std::isfinite(value) ? value : otherwise; }

// A probability that underflows is small, not nothing.
double Probability(double p) {
  return std::isfinite(p) ? std::clamp(p, std::numeric_limits<double>::min(), 1.0) : 1.0;
}

Json ParametersJson(const std::vector<ParameterValue>& parameters) {
  Json object = Json::object();
  for (const ParameterValue& parameter : parameters) {
    // A value that the records leave open is one of many.
    const bool open = !std::isfinite(parameter.standard_error);
    object[parameter.name] = {{"value", open ? Json(nullptr) : Known(parameter.value)},
                              {"se", Known(parameter.standard_error)},
                              {"unit", parameter.unit}};
  }
  return object;
}

Json EvidenceJson(const diagnosis::Evidence& evidence) {
  return {{"delta_bic", Finite(evidence.delta_bic)},
          {"p_value", Probability(evidence.p_value)},
          {"heldout_log_likelihood_gain", Finite(evidence.heldout_gain)}};
}

Json NominalJson(const DiagnosisReport& report) {
  const diagnosis::Study& study = *report.input.study;
  const diagnosis::ModelFit& fit = report.result.nominal;
  Json parameters = ParametersJson(fit.nominal);
  for (const ParameterValue& before : report.nominal_before) {
    if (parameters.contains(before.name)) parameters[before.name]["before"] = Known(before.value);
  }
  Json causes = Json::array();
  for (std::size_t i = 0; i < fit.causes.size(); ++i) {
    causes.push_back({{"name", study.causes()[fit.causes[i]].name},
                      {"parameters", ParametersJson(fit.cause_parameters[i])}});
  }
  return {
      {"parameters", std::move(parameters)},
      {"heldout_rmse", Finite(report.result.nominal_heldout_rmse * study.unit_per_si())},
      {"unit", study.unit()},
      {"model", report.model.empty() ? "nominal " + std::string(NameOf(report.input.kind)) : report.model},
      {"causes", std::move(causes)}};
}

Json CausesJson(const DiagnosisReport& report) {
  Json causes = Json::array();
  for (const diagnosis::Finding& finding : report.result.causes) {
    const diagnosis::CauseRule& rule = report.input.study->causes()[finding.index];
    causes.push_back({{"name", rule.name},
                      {"where", WhereText(rule.where)},
                      {"parameters", ParametersJson(finding.parameters)},
                      {"evidence", EvidenceJson(finding.evidence)},
                      {"indistinguishable_from", finding.indistinguishable_from},
                      {"share_of_explainable_variance", Finite(finding.share_of_explainable)},
                      {"catalogue", rule.effect},
                      {"sentence", rule.sentence},
                      {"what_to_do", rule.what_to_do}});
    if (const diagnosis::NullEvidence& simulated = finding.simulated; simulated.simulated > 0) {
      causes.back()["simulated_without_it"] = {{"records", simulated.simulated},
                                               {"as_strong", simulated.as_strong},
                                               {"strongest_delta_bic", Finite(simulated.strongest)},
                                               {"p_value", simulated.p_value()}};
    }
  }
  return causes;
}

Json NuisanceTermsJson(const DiagnosisReport& report) {
  Json nuisance_terms = Json::array();
  for (const diagnosis::Finding& finding : report.result.nuisance_terms) {
    nuisance_terms.push_back({{"name", report.input.study->causes()[finding.index].name},
                              {"physical", false},
                              {"parameters", ParametersJson(finding.parameters)},
                              {"evidence", EvidenceJson(finding.evidence)},
                              {"share_of_explainable_variance", Finite(finding.share_of_explainable)}});
  }
  return nuisance_terms;
}

Json CandidatesJson(const DiagnosisReport& report) {
  Json candidates = Json::array();
  for (const diagnosis::CandidateResult& candidate : report.result.candidates) {
    const diagnosis::CauseRule& rule = report.input.study->causes()[candidate.index];
    std::vector<std::string> parameters;
    for (const diagnosis::ParameterRule& parameter : rule.parameters) parameters.push_back(parameter.name);
    candidates.push_back({{"name", rule.name},
                          {"cause", rule.named},
                          {"parameters", parameters},
                          {"passed", candidate.passed},
                          {"evidence", EvidenceJson(candidate.evidence)},
                          {"objection", candidate.objection}});
  }
  return candidates;
}

Json QuantitiesJson(const DiagnosisReport& report) {
  const diagnosis::Study& study = *report.input.study;
  const auto nominal = study.Quantities(report.result.nominal.predicted);
  const auto extended = study.Quantities(report.result.extended.predicted);
  Json quantities = Json::object();
  for (std::size_t i = 0; i < nominal.size() && i < extended.size(); ++i) {
    quantities[nominal[i].name] = {{"measured", Known(nominal[i].measured)},
                                   {"nominal", Known(nominal[i].predicted)},
                                   {"extended", Known(extended[i].predicted)}};
  }
  return quantities;
}

Json RecordsJson(const StudyInput& input) {
  Json records = Json::array();
  for (const RecordIdentity& record : input.records) {
    Json row{{"file", record.file}, {"sha256", record.sha256}, {"rows", record.rows}};
    if (!record.group.empty()) row["group"] = record.group;
    records.push_back(std::move(row));
  }
  return records;
}

Json UnexplainedJson(const DiagnosisReport& report) {
  const diagnosis::Unexplained& residual = report.result.residual;
  Json unexplained{{"share_of_residual_variance", Finite(residual.share_of_residual_variance)},
                   {"signature", SignatureOf(report)},
                   {"after_everything_found", residual.signature},
                   {"ljung_box_p", Probability(residual.ljung_box_p)},
                   {"runs_p", Probability(residual.runs_p)}};
  if (!report.formula.formula.empty()) {
    unexplained["proposed_formula"] = {{"formula", report.formula.formula},
                                       {"heldout_share", Finite(report.formula.heldout_share)},
                                       {"physical", false},
                                       {"sentence", report.formula.sentence}};
  }
  return unexplained;
}

Json PlainWordsJson(const DiagnosisReport& report) {
  const PlainWords words = PlainWordsOf(report);
  return {{"what_is_missing", words.what_is_missing},
          {"how_sure", words.how_sure},
          {"what_to_do", words.what_to_do}};
}

}  // namespace

nlohmann::ordered_json DiagnosisJson(const DiagnosisReport& report) {
  const diagnosis::Diagnosis& result = report.result;
  const diagnosis::Study& study = *report.input.study;
  Json document{{"verdict", VerdictText(result.verdict)},
                {"kind", NameOf(report.input.kind)},
                {"plain_words", PlainWordsJson(report)},
                {"nominal", NominalJson(report)},
                {"causes", CausesJson(report)},
                {"extended",
                 {{"heldout_rmse", Finite(result.extended_heldout_rmse * study.unit_per_si())},
                  {"noise_floor", Finite(result.noise_floor * study.unit_per_si())},
                  {"unit", study.unit()},
                  {"parameters", ParametersJson(result.extended.nominal)}}},
                {"gain",
                 {{"heldout_rmse_reduction", Finite(result.gain.reduction)},
                  {"ci95", {Finite(result.gain.low), Finite(result.gain.high)}}}},
                {"unexplained", UnexplainedJson(report)},
                {"trusted_regions", TrustJson(report)},
                {"to_settle", MeasurementsToSettle(report)},
                {"corrections", NuisanceTermsJson(report)},
                {"candidates", CandidatesJson(report)},
                {"quantities", QuantitiesJson(report)},
                {"records", RecordsJson(report.input)},
                {"notes", result.notes},
                {"warnings", report.input.WarningTexts()},
                {"software", daq::Software()}};
  if (report.power) document["power"] = PowerJson(report);
  return document;
}

}  // namespace strainwave::bench
