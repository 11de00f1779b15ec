// SPDX-License-Identifier: Apache-2.0
#include "bench/faults/fault_json.h"

#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "analysis/prediction/class_scores.h"

namespace strainwave::bench {
namespace {

namespace faults = analysis::faults;
using Json = nlohmann::ordered_json;

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json AccuraciesJson(const std::vector<FaultSplit>& splits, const FaultTableResult& result) {
  Json json = Json::object();
  for (std::size_t k = 0; k < splits.size(); ++k) {
    const auto accuracy = result.splits[k].Accuracy();
    json[splits[k].name] = accuracy ? Json(*accuracy) : Json(nullptr);
  }
  return json;
}

Json ConfusionJson(const faults::ClassScores& scores, const std::vector<std::string>& names) {
  Json json = Json::object();
  for (std::size_t own = 0; own < names.size(); ++own) {
    for (std::size_t told = 0; told < names.size(); ++told)
      json[names[own]][names[told]] =
          scores.confusion(static_cast<Eigen::Index>(own), static_cast<Eigen::Index>(told));
  }
  return json;
}

Json LabelsJson(const faults::LabelScores& scores, const std::vector<std::string>& names) {
  Json json = Json::object();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const faults::LabelCounts& counts = scores.labels[k];
    json[names[k]] = {
        {"present_told", counts.present_told},         {"absent_told", counts.absent_told},
        {"present_missed", counts.present_missed},     {"absent_not_told", counts.absent_not_told},
        {"accuracy", NumberOrNull(counts.Accuracy())}, {"f1", NumberOrNull(counts.F1())}};
  }
  return json;
}

Json SplitJson(const FaultSplit& split, const FaultSplitResult& result) {
  Json json{{"meaning", split.meaning},     {"honest", split.honest},
            {"groups", split.folds.groups}, {"folds", split.folds.folds.size()},
            {"tested", result.Tested()},    {"not_tested", split.folds.untested.size()}};
  if (!split.limit.empty()) json["limit"] = split.limit;
  const auto accuracy = result.Accuracy();
  if (!accuracy) return json;
  const auto tested = static_cast<double>(result.Tested());
  const auto [low, high] = analysis::prediction::WilsonInterval(*accuracy * tested, tested);
  json["accuracy"] = {{"value", *accuracy}, {"low", low}, {"high", high}};
  if (result.classes) {
    json["undecided"] = static_cast<double>(result.classes->undecided) / tested;
    json["decided_accuracy"] = NumberOrNull(result.classes->decided_accuracy);
  }
  if (result.labels) {
    json["undecided"] = static_cast<double>(result.labels->undecided) / tested;
    json["label_errors"] = result.labels->one_wrong;
  }
  return json;
}

Json BandsJson(const FaultRecords& records, const FaultTable& table) {
  Json bands = Json::array();
  double high_hz = 0.5 * records.sample_rate_hz;
  for (int level = 1; level <= table.settings.details.levels; ++level, high_hz *= 0.5)
    bands.push_back({{"level", level}, {"low_hz", 0.5 * high_hz}, {"high_hz", high_hz}});
  return bands;
}

}  // namespace

Json FaultReport(const std::filesystem::path& folder, const FaultRecords& records,
                 const FaultOutcome& outcome) {
  const std::vector<std::string>& names = records.labels.outputs;
  const FaultTableResult& chosen = outcome.tables[outcome.chosen];
  const FaultTable& details = records.tables.front();
  Json json{{"classes", names},
            {"accuracy", AccuraciesJson(outcome.splits, chosen)},
            {"confusion", Json::object()},
            {"labels", records.labels.labels},
            {"features", NameOf(chosen.set)},
            {"line", faults::NameOf(outcome.model.line)},
            {"compared", Json::object()},
            {"splits", Json::object()}};
  for (std::size_t k = 0; k < outcome.splits.size(); ++k) {
    const FaultSplitResult& result = chosen.splits[k];
    if (result.classes) json["confusion"][outcome.splits[k].name] = ConfusionJson(*result.classes, names);
    if (result.labels) json["confusion"][outcome.splits[k].name] = LabelsJson(*result.labels, names);
    json["splits"][outcome.splits[k].name] = SplitJson(outcome.splits[k], result);
  }
  for (const FaultTableResult& table : outcome.tables)
    json["compared"][std::string(NameOf(table.set))] = {{"accuracy", AccuraciesJson(outcome.splits, table)},
                                                        {"honest_accuracy", table.honest}};
  for (std::size_t k = 0; k < outcome.by_levels.size(); ++k)
    json["accuracy_by_levels"][std::to_string(k + 1)] = AccuraciesJson(outcome.splits, outcome.by_levels[k]);
  for (const auto& [wavelet, result] : outcome.by_wavelet)
    json["accuracy_by_wavelet"][wavelet] = AccuraciesJson(outcome.splits, result);
  json["undecided_rule"] = {{"least_probability", outcome.model.rule.least_probability},
                            {"least_margin", outcome.model.rule.least_margin},
                            {"outside_training_above", 1.0}};
  if (outcome.model.labels) {
    for (std::size_t k = 0; k < names.size(); ++k)
      json["thresholds"][names[k]] = outcome.model.thresholds(static_cast<Eigen::Index>(k));
  }
  const std::set<std::string> units(records.labels.unit.begin(), records.labels.unit.end());
  json["folder"] = folder.string();
  json["records"] = records.files.size();
  json["units"] = units.size();
  json["channels"] = records.channels;
  json["sample_rate_hz"] = records.sample_rate_hz;
  json["wavelet"] = details.settings.details.wavelet;
  json["levels"] = details.settings.details.levels;
  json["bands"] = BandsJson(records, details);
  json["limits"] = outcome.limits;
  json["notes"] = records.notes;
  json["warnings"] = WarningTexts(records.warnings, NamedFiles::kYes);
  return json;
}

Json VerdictJson(const FaultModel& model, const FaultVerdict& verdict) {
  Json json{{"file", verdict.file}, {"class", verdict.name}, {"probabilities", Json::object()}};
  for (std::size_t k = 0; k < verdict.probability.size(); ++k)
    json["probabilities"][model.predictor.outputs[k]] = verdict.probability[k];
  json["undecided"] = verdict.undecided;
  if (!verdict.why.empty()) json["why"] = verdict.why;
  json["distance"] = verdict.distance;
  json["outside_training"] = !(verdict.distance <= 1.0);
  if (!verdict.group.empty()) json["group"] = verdict.group;
  if (model.labels) {
    json["faults"] = Json::array();
    for (std::size_t k = 0; k < verdict.present.size(); ++k) {
      if (verdict.present[k]) json["faults"].push_back(model.predictor.outputs[k]);
    }
  }
  for (const BearingSign& sign : verdict.bearing)
    json["bearing"][sign.part] = {{"order", sign.order},
                                  {"frequency_hz", sign.frequency_Hz},
                                  {"prominence_db", NumberOrNull(sign.prominence_dB)}};
  return json;
}

}  // namespace strainwave::bench
