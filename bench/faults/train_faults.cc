// SPDX-License-Identifier: Apache-2.0
#include "bench/faults/train_faults.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/on_all_processors.h"
#include "bench/errors/bench_error.h"
#include "bench/faults/fault_json.h"
#include "bench/prediction/network_json.h"
#include "bench/sha256.h"

namespace strainwave::bench {
namespace {

namespace faults = analysis::faults;
namespace prediction = analysis::prediction;
using Json = nlohmann::ordered_json;

constexpr int kRandomFolds = 5;
constexpr const char* kUnitLeftOut = "unit_left_out";

prediction::Samples SamplesOf(const FaultRecords& records, const FaultTable& table) {
  prediction::Samples samples;
  samples.features = table.values;
  samples.targets = records.labels.targets;
  samples.specimen = NumbersOfGroups(records.labels.unit);
  for (std::size_t i = 0; i < records.files.size(); ++i) samples.cycle.push_back(static_cast<double>(i));
  samples.inputs = table.names;
  samples.outputs = records.labels.outputs;
  samples.classes = !records.labels.labels;
  return samples;
}

FaultSplit SplitByGroup(const FaultLabels& labels, const std::string& name, const std::string& of,
                        const std::vector<std::string>& group) {
  FaultSplit split{.name = name,
                   .meaning = fmt::format("each {} left out in turn", of),
                   .honest = true,
                   .folds = faults::FoldsByGroup(NumbersOfGroups(group), labels.targets),
                   .limit = {}};
  if (split.folds.groups < 2) {
    split.limit =
        fmt::format("{}: all records have one {}, {}: it cannot be left out", name, of, group.front());
  } else if (split.folds.empty()) {
    split.limit = fmt::format("{}: each {} stands in one {} alone: what is left out, nothing teaches", name,
                              labels.labels ? "fault" : "class", of);
  } else if (!split.folds.untested.empty()) {
    split.limit = fmt::format("{}: {} of {} records are not tested: what they show is in no other {}", name,
                              split.folds.untested.size(), group.size(), of);
  }
  return split;
}

FaultSplitResult ScoresOf(const FaultRecords& records, const FaultSplit& split,
                          const faults::FaultCrossFit& cross, const faults::UndecidedRule& rule) {
  FaultSplitResult result;
  if (split.folds.empty()) return result;
  const Eigen::MatrixXd& targets = records.labels.targets;
  if (!records.labels.labels) {
    result.classes = faults::ScoreClasses(targets, cross.probability, cross.distance, rule);
    return result;
  }
  const Eigen::RowVectorXd half = Eigen::RowVectorXd::Constant(targets.cols(), 0.5);
  result.labels = faults::ScoreLabels(targets, cross.probability, half, cross.distance, rule);
  return result;
}

double HonestAccuracy(const std::vector<FaultSplit>& splits, const FaultTableResult& result) {
  for (const bool honest : {true, false}) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t k = 0; k < splits.size(); ++k) {
      const auto accuracy = result.splits[k].Accuracy();
      if (splits[k].honest != honest || !accuracy) continue;
      sum += *accuracy;
      ++count;
    }
    if (count > 0) return sum / count;
  }
  return 0.0;
}

// The details D1 to D`kept` of a table.
FaultTable FirstLevels(const FaultTable& table, std::size_t channels, int kept) {
  FaultTable first = table;
  first.settings.details.levels = kept;
  first.names.clear();
  std::vector<Eigen::Index> columns;
  const auto levels = static_cast<std::size_t>(table.settings.details.levels);
  for (std::size_t c = 0; c < channels; ++c) {
    for (std::size_t level = 0; level < static_cast<std::size_t>(kept); ++level) {
      columns.push_back(static_cast<Eigen::Index>(c * levels + level));
      first.names.push_back(table.names[c * levels + level]);
    }
  }
  first.values = table.values(Eigen::all, columns);
  return first;
}

std::size_t Folds(const std::vector<FaultSplit>& splits) {
  std::size_t folds = 0;
  for (const FaultSplit& split : splits) folds += split.folds.folds.size();
  return folds;
}

FeatureRecipe RecipeOf(const FaultRecords& records, const FaultTable& table) {
  return {.features = table.settings,
          .channels = records.channels,
          .sample_rate_hz = records.sample_rate_hz,
          .decimates = records.decimates,
          .window = {.samples = 0, .turns = table.turns},
          .least_samples = table.least_samples,
          .baseline_records = 0,
          .envelope = {},
          .inputs = table.names};
}

std::string BytesOf(const Eigen::MatrixXd& matrix) {
  return {reinterpret_cast<const char*>(matrix.data()),
          sizeof(double) * static_cast<std::size_t>(matrix.size())};
}

// For predictor.json and the model card of an export (training_json.h).
std::string PredictorTraining(const std::filesystem::path& folder, const FaultRecords& records,
                              const prediction::Samples& samples, const FaultOutcome& outcome,
                              const FaultTableResult& chosen, const FaultJob& job) {
  std::map<std::string, std::size_t> units;
  for (const std::string& unit : records.labels.unit) ++units[unit];
  Json campaigns = Json::array();
  for (const auto& [unit, count] : units)
    campaigns.push_back({{"folder", folder.string()}, {"specimen", unit}, {"records", count}});
  Json splits = Json::array();
  for (std::size_t k = 0; k < outcome.splits.size(); ++k) {
    const FaultSplit& split = outcome.splits[k];
    const auto& scores = chosen.splits[k].classes;
    // The card of a model whose outputs are no probabilities has no place for them.
    if (!scores || job.network.line != faults::FaultLine::kOurs) continue;
    splits.push_back({{"split", split.name},
                      {"meaning", split.meaning},
                      {"train", split.folds.folds.front().train.size()},
                      {"test", scores->tested},
                      {"scores", {{"network", {{"accuracy_percent", 100.0 * scores->accuracy}}}}}});
  }
  return Json{{"campaigns", std::move(campaigns)},
              {"data_sha256", Sha256(BytesOf(samples.features) + BytesOf(samples.targets))},
              {"records", samples.size()},
              {"predicts", samples.classes ? "classes" : "values"},
              {"design", fmt::format("faults, {}", faults::NameOf(job.network.line))},
              {"splits", std::move(splits)},
              {"notes", records.notes}}
      .dump();
}

std::size_t ChosenOf(const std::vector<FaultTableResult>& tables, FaultFeatures asked) {
  const auto place = [&](FeatureSet set) {
    return static_cast<std::size_t>(std::ranges::find(tables, set, &FaultTableResult::set) - tables.begin());
  };
  if (asked == FaultFeatures::kDetails) return place(FeatureSet::kDetails);
  if (asked == FaultFeatures::kEnvelopeOrders) {
    if (place(FeatureSet::kEnvelopeOrders) == tables.size())
      Refuse("--features", "envelope_orders", "details: not every record tells a steady speed");
    return place(FeatureSet::kEnvelopeOrders);
  }
  // The first of equals.
  const auto best = std::ranges::max_element(tables, {}, &FaultTableResult::honest);
  return static_cast<std::size_t>(best - tables.begin());
}

}  // namespace

std::optional<double> FaultSplitResult::Accuracy() const {
  if (classes) return classes->accuracy;
  if (labels) return labels->exact;
  return std::nullopt;
}

std::size_t FaultSplitResult::Tested() const {
  return classes ? classes->tested : labels ? labels->tested : 0;
}

std::vector<FaultSplit> FaultSplitsOf(const FaultLabels& labels, std::uint64_t seed) {
  std::vector<FaultSplit> splits;
  splits.push_back({.name = "random",
                    .meaning =
                        "records at random, as the study does: flatters, since neighbours of each tested "
                        "record were trained on",
                    .honest = false,
                    .folds = faults::FoldsAtRandom(labels.targets, kRandomFolds, seed),
                    .limit = {}});
  if (splits.back().folds.empty())
    splits.back().limit = "random: no class has two records: what is left out, nothing teaches";
  splits.push_back(SplitByGroup(labels, kUnitLeftOut, "unit", labels.unit));
  for (const FaultLabels::Group& group : labels.groups) {
    if (group.column == "unit") continue;
    splits.push_back(SplitByGroup(labels, group.column, group.column, group.value));
  }
  if (labels.labels) {
    faults::FaultFolds pairs = faults::SinglesToPairs(labels.targets);
    if (!pairs.empty())
      splits.push_back({.name = "pairs_left_out",
                        .meaning = "trained on records of one fault at most, tested on those of several",
                        .honest = true,
                        .folds = std::move(pairs),
                        .limit = {}});
  }
  return splits;
}

FaultTableResult TestFaultTable(const FaultRecords& records, const FaultTable& table,
                                const std::vector<FaultSplit>& splits, const FaultJob& job,
                                const std::function<bool()>& done) {
  const prediction::Samples samples = SamplesOf(records, table);
  std::vector<faults::FaultCrossFit> crosses;
  for (const FaultSplit& split : splits)
    crosses.push_back(faults::CrossFitFaults(samples, split.folds, job.network, OnAllProcessors, done));
  // What lies outside is judged as the model will do it: by the records of units left out.
  const double kept = faults::DistanceKeptOutside(crosses[splits[1].folds.empty() ? 0 : 1]);
  FaultTableResult result{.set = table.settings.set, .splits = {}, .honest = 0.0};
  for (std::size_t k = 0; k < splits.size(); ++k) {
    crosses[k].distance /= kept;
    result.splits.push_back(ScoresOf(records, splits[k], crosses[k], job.rule));
  }
  result.honest = HonestAccuracy(splits, result);
  return result;
}

FaultOutcome TrainFaults(const std::filesystem::path& folder, const FaultRecords& records,
                         const FaultJob& job, const FaultTrainingProgress& progress) {
  FaultJob own = job;
  own.network.labels = records.labels.labels;
  std::vector<FaultSplit> splits = FaultSplitsOf(records.labels, own.network.seed);
  // The last fit, its calibration and the course of the training are some folds more.
  constexpr std::size_t kLast = 12;
  const FaultTable& details = records.tables.front();
  const std::size_t compared =
      own.compare ? static_cast<std::size_t>(details.settings.details.levels) + records.other_wavelets.size()
                  : 0;
  const double all = static_cast<double>((records.tables.size() + compared) * Folds(splits) + kLast);
  std::mutex telling;
  double done = 0.0;
  std::string step;
  const auto count = [&] {
    const std::lock_guard lock(telling);
    done += 1.0;
    return progress(step, std::min(1.0, done / all));
  };
  std::vector<FaultTableResult> tables;
  for (const FaultTable& table : records.tables) {
    step = fmt::format("testing {}", NameOf(table.settings.set));
    tables.push_back(TestFaultTable(records, table, splits, own, count));
  }
  const std::size_t chosen = ChosenOf(tables, own.features);
  std::vector<FaultTableResult> by_levels;
  std::vector<std::pair<std::string, FaultTableResult>> by_wavelet;
  if (own.compare) {
    step = "comparing levels and wavelets";
    for (int kept = 1; kept < details.settings.details.levels; ++kept)
      by_levels.push_back(
          TestFaultTable(records, FirstLevels(details, records.channels.size(), kept), splits, own, count));
    by_levels.push_back(tables.front());
    by_wavelet.emplace_back(details.settings.details.wavelet, tables.front());
    for (const FaultTable& other : records.other_wavelets)
      by_wavelet.emplace_back(other.settings.details.wavelet,
                              TestFaultTable(records, other, splits, own, count));
  }
  const FaultTable& table = records.tables[chosen];
  const prediction::Samples samples = SamplesOf(records, table);
  step = "training the model";
  // Calibrated on what is most like a record to come: another unit, where units can be left out.
  const std::size_t like_use = splits[1].folds.empty() ? 0 : 1;
  const faults::FaultCrossFit cross =
      faults::CrossFitFaults(samples, splits[like_use].folds, own.network, OnAllProcessors, count);
  FaultOutcome outcome{.splits = std::move(splits),
                       .tables = std::move(tables),
                       .chosen = chosen,
                       .by_levels = std::move(by_levels),
                       .by_wavelet = std::move(by_wavelet),
                       .limits = records.labels.limits,
                       .course = faults::CourseOfTraining(samples, own.network),
                       .left_out = cross.probability,
                       .left_out_by = {},
                       .model = {.predictor = {.recipe = RecipeOf(records, table),
                                               .outputs = records.labels.outputs,
                                               .fitted = faults::FitFaults(samples, own.network, cross),
                                               .training_json = {}},
                                 .labels = records.labels.labels,
                                 .line = own.network.line,
                                 .rule = own.rule,
                                 .thresholds = {},
                                 .bearing = own.bearing,
                                 .report_json = {}}};
  outcome.left_out_by = outcome.splits[like_use].name;
  if (outcome.model.labels)
    outcome.model.thresholds = faults::LabelThresholds(samples.targets, cross.probability);
  for (const FaultSplit& split : outcome.splits) {
    if (!split.limit.empty()) outcome.limits.push_back(split.limit);
  }
  outcome.model.predictor.training_json =
      PredictorTraining(folder, records, samples, outcome, outcome.tables[chosen], own);
  outcome.model.report_json = FaultReport(folder, records, outcome).dump();
  return outcome;
}

}  // namespace strainwave::bench
