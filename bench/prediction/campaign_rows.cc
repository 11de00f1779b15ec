// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/quantities.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/cycle_results.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/campaign_features.h"
#include "bench/prediction/source_rows.h"

namespace strainwave::bench {
namespace {

// The outputs of one cycle, or which of them it has not.
struct Labels {
  std::vector<double> values;
  std::string missing;
};
Labels LabelsOf(const std::vector<Result>& results, const std::vector<std::string>& outputs) {
  Labels labels;
  for (const std::string& output : outputs) {
    const auto result = FindResult(results, output);
    if (!result) {
      labels.missing = output + " was not measured";
      return labels;
    }
    if (!IsSound(*result) || !std::isfinite(result->value)) {
      labels.missing = fmt::format("{} is flagged: {}", output, result->flag);
      return labels;
    }
    labels.values.push_back(result->value);
  }
  return labels;
}

}  // namespace

std::vector<std::string> CampaignOutputs(const std::filesystem::path& folder) {
  const Journal journal = OpenCampaign({folder}, Database::Mode::kReadOnly);
  std::vector<std::string> outputs;
  for (const CycleRow& row : journal.Cycles()) {
    if (row.outcome != "complete" || row.cycle < 1) continue;
    const std::vector<Result> results = journal.Results(row.cycle, 0);
    for (const analysis::Quantity& quantity : analysis::kPredictedQuantities) {
      if (FindResult(results, quantity.name)) outputs.emplace_back(quantity.name);
    }
    if (!outputs.empty()) return outputs;
  }
  Refuse(
      folder, "no cycle has a result to predict",
      fmt::format("one of {}", analysis::Listed(analysis::kPredictedQuantities, &analysis::Quantity::name)));
}

SourceRows ReadCampaignRows(const std::filesystem::path& path, const SourceSettings& settings,
                            const std::vector<std::string>& outputs, const SourceProgress& progress) {
  const CampaignFeatures features =
      FeaturesOfCampaign(path, settings.features, settings.motor_torque, progress);
  const CampaignFolder folder{path};
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
  const std::size_t all_channels = features.channels.size() + features.torque_channels.size();
  SourceRows rows{
      .source = path,
      .specimen = journal.Property("specimen").value_or(""),
      .shape = {features.channels, features.names,
                features.names.size() / all_channels * features.channels.size(), features.sample_rate_hz},
      .least_samples = features.least_samples,
      .operating = features.operating,
      .place = {},
      .features = {},
      .targets = {},
      .classes = {},
      .notes = {}};
  for (const std::string& note : features.notes) rows.notes.push_back(path.string() + ": " + note);
  for (std::size_t i = 0; i < features.cycle.size(); ++i) {
    Labels labels = LabelsOf(journal.Results(features.cycle[i], 0), outputs);
    if (!labels.missing.empty()) {
      rows.notes.push_back(
          fmt::format("{}: cycle {} left out: {}", path.string(), features.cycle[i], labels.missing));
      continue;
    }
    rows.place.push_back(features.cycle[i]);
    rows.features.emplace_back(features.values.row(static_cast<Eigen::Index>(i)));
    rows.targets.push_back(std::move(labels.values));
  }
  return rows;
}

}  // namespace strainwave::bench
