// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/training_data.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/campaign/campaign_error.h"
#include "bench/campaign/cycle_results.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/prediction/campaign_features.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kFewestRecords = 20;

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
    if (!(result->flag.empty() || result->flag.starts_with(kThermalFlag)) || !std::isfinite(result->value)) {
      labels.missing = fmt::format("{} is flagged: {}", output, result->flag);
      return labels;
    }
    labels.values.push_back(result->value);
  }
  return labels;
}

// Rows while they are collected.
struct Rows {
  std::vector<Eigen::RowVectorXd> features;
  std::vector<std::vector<double>> targets;
};

void RequireLike(const TrainingData& data, const CampaignFeatures& features,
                 const std::filesystem::path& folder) {
  if (features.channels != data.channels || features.sample_rate_hz != data.sample_rate_hz ||
      features.names != data.samples.inputs) {
    Refuse(
        folder,
        fmt::format("vibration of {} at {} Hz", fmt::join(features.channels, " "), features.sample_rate_hz),
        fmt::format("{} at {} Hz, as in {}", fmt::join(data.channels, " "), data.sample_rate_hz,
                    data.sources.front().folder));
  }
}

void TakeCampaign(TrainingData& data, Rows& rows, std::map<std::string, int>& specimens,
                  const std::filesystem::path& path, const CampaignFeatures& features) {
  const CampaignFolder folder{path};
  const Journal journal = Journal::Open(folder.Journal(), Database::Mode::kReadOnly);
  TrainingSource source{path.string(), journal.Property("specimen").value_or(path.string()), 0};
  const int number = specimens.try_emplace(source.specimen, static_cast<int>(specimens.size())).first->second;
  for (const std::string& note : features.notes) data.notes.push_back(path.string() + ": " + note);
  for (std::size_t i = 0; i < features.cycle.size(); ++i) {
    const Labels labels = LabelsOf(journal.Results(features.cycle[i], 0), data.samples.outputs);
    if (!labels.missing.empty()) {
      data.notes.push_back(
          fmt::format("{}: cycle {} left out: {}", path.string(), features.cycle[i], labels.missing));
      continue;
    }
    rows.features.emplace_back(features.values.row(static_cast<Eigen::Index>(i)));
    rows.targets.push_back(labels.values);
    data.samples.specimen.push_back(number);
    data.samples.cycle.push_back(features.cycle[i]);
    ++source.records;
  }
  data.sources.push_back(std::move(source));
}

void FillMatrices(TrainingData& data, const Rows& rows) {
  const auto count = static_cast<Eigen::Index>(rows.features.size());
  data.samples.features.resize(count, static_cast<Eigen::Index>(data.samples.inputs.size()));
  data.samples.targets.resize(count, static_cast<Eigen::Index>(data.samples.outputs.size()));
  for (Eigen::Index row = 0; row < count; ++row) {
    const auto i = static_cast<std::size_t>(row);
    data.samples.features.row(row) = rows.features[i];
    for (std::size_t column = 0; column < rows.targets[i].size(); ++column) {
      data.samples.targets(row, static_cast<Eigen::Index>(column)) = rows.targets[i][column];
    }
  }
}

// A feature that some record has not can be no input.
void LeaveOutUndefined(TrainingData& data) {
  std::vector<Eigen::Index> finite;
  std::size_t vibration = 0;
  for (Eigen::Index column = 0; column < data.samples.features.cols(); ++column) {
    if (!data.samples.features.col(column).allFinite()) continue;
    finite.push_back(column);
    vibration += static_cast<std::size_t>(column) < data.vibration_features ? 1 : 0;
  }
  const auto left_out = static_cast<std::size_t>(data.samples.features.cols()) - finite.size();
  if (left_out > 0) {
    data.notes.push_back(fmt::format("{} features left out that are not defined for every record", left_out));
  }
  data.samples = Inputs(data.samples, finite);
  data.vibration_features = vibration;
}

void RequireVariation(const TrainingData& data, const std::filesystem::path& folder) {
  for (std::size_t column = 0; column < data.samples.outputs.size(); ++column) {
    const auto values = data.samples.targets.col(static_cast<Eigen::Index>(column));
    if (values.maxCoeff() > values.minCoeff()) continue;
    Refuse(folder, fmt::format("{} is {} in every cycle", data.samples.outputs[column], values(0)),
           "something that changes over the campaign");
  }
}

std::string_view BytesOf(const Eigen::MatrixXd& values) {
  return {reinterpret_cast<const char*>(values.data()),
          static_cast<std::size_t>(values.size()) * sizeof(double)};
}

std::vector<std::string> OutputsIn(const std::filesystem::path& path) {
  const Journal journal = Journal::Open(CampaignFolder{path}.Journal(), Database::Mode::kReadOnly);
  std::vector<std::string> outputs;
  for (const char* quantity : kPredictedQuantities) {
    if (!journal.Series(quantity).empty()) outputs.emplace_back(quantity);
  }
  return outputs;
}

}  // namespace

TrainingData ReadTrainingData(const std::vector<std::filesystem::path>& folders,
                              const analysis::features::WaveletRecipe& recipe,
                              const std::vector<std::string>& outputs,
                              const std::function<void(const std::string&, double)>& progress) {
  TrainingData data;
  Rows rows;
  std::map<std::string, int> specimens;
  for (std::size_t k = 0; k < folders.size(); ++k) {
    const CampaignFeatures features =
        FeaturesOfCampaign(folders[k], recipe, [&](std::size_t done, std::size_t all) {
          const double share = static_cast<double>(done) / static_cast<double>(all);
          if (progress)
            progress("features", (static_cast<double>(k) + share) / static_cast<double>(folders.size()));
        });
    if (k == 0) {
      data.channels = features.channels;
      data.sample_rate_hz = features.sample_rate_hz;
      data.least_samples = features.least_samples;
      data.samples.inputs = features.names;
      data.samples.outputs = outputs.empty() ? OutputsIn(folders[k]) : outputs;
      const std::size_t all_channels = features.channels.size() + features.torque_channels.size();
      data.vibration_features = features.names.size() / all_channels * features.channels.size();
    }
    RequireLike(data, features, folders[k]);
    data.least_samples = std::min(data.least_samples, features.least_samples);
    TakeCampaign(data, rows, specimens, folders[k], features);
  }
  if (rows.features.size() < kFewestRecords) {
    Refuse(folders.front(),
           fmt::format("{} cycles with vibration and {}{}", rows.features.size(),
                       fmt::join(data.samples.outputs, ", "),
                       data.notes.empty() ? "" : "; " + data.notes.front()),
           fmt::format("at least {}", kFewestRecords));
  }
  FillMatrices(data, rows);
  LeaveOutUndefined(data);
  RequireVariation(data, folders.front());
  data.sha256 =
      Sha256(std::string(BytesOf(data.samples.features)) + std::string(BytesOf(data.samples.targets)));
  return data;
}

}  // namespace strainwave::bench
