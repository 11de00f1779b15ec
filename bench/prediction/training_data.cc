// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/training_data.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/campaign/folder.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/measurement_paths.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

void KeepVibration(SourceRows& rows) {
  rows.shape.names.resize(rows.shape.vibration_features);
  for (Eigen::RowVectorXd& row : rows.features) {
    row.conservativeResize(static_cast<Eigen::Index>(rows.shape.vibration_features));
  }
}

void RequireLike(const SourceRows& rows, const SourceRows& first) {
  if (rows.shape.channels == first.shape.channels &&
      rows.shape.sample_rate_hz == first.shape.sample_rate_hz && rows.shape.names == first.shape.names) {
    return;
  }
  Refuse(
      rows.source,
      fmt::format("vibration of {} at {} Hz", fmt::join(rows.shape.channels, " "), rows.shape.sample_rate_hz),
      fmt::format("{} at {} Hz, as in {}", fmt::join(first.shape.channels, " "), first.shape.sample_rate_hz,
                  first.source.string()));
}

std::size_t CountRows(const std::vector<SourceRows>& sources) {
  std::size_t count = 0;
  for (const SourceRows& rows : sources) count += rows.features.size();
  return count;
}

void RequireEnough(const std::vector<SourceRows>& sources, const TrainingData& data, bool campaigns) {
  if (CountRows(sources) >= kFewestRows) return;
  Refuse(
      sources.front().source,
      fmt::format("{} {} with vibration and {}{}", CountRows(sources), campaigns ? "cycles" : "windows",
                  fmt::join(data.samples.outputs, ", "), data.notes.empty() ? "" : "; " + data.notes.front()),
      fmt::format("at least {}", kFewestRows));
}

// The names of the classes become the outputs.
void NameClasses(const std::vector<SourceRows>& sources, analysis::prediction::Samples& samples) {
  std::set<std::string> names;
  for (const SourceRows& rows : sources) names.insert(rows.classes.begin(), rows.classes.end());
  if (names.size() < 2) {
    Refuse(sources.front().source, fmt::format("the class is {} in every record", fmt::join(names, ", ")),
           "records of two classes or more");
  }
  samples.outputs.assign(names.begin(), names.end());
}

// All rows of all sources, one below the other.
void FillSamples(const std::vector<SourceRows>& sources, TrainingData& data) {
  analysis::prediction::Samples& samples = data.samples;
  const auto count = static_cast<Eigen::Index>(CountRows(sources));
  samples.features.resize(count, static_cast<Eigen::Index>(samples.inputs.size()));
  samples.targets = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(samples.outputs.size()));
  std::map<std::string, int> specimens;
  std::map<int, double> windows;  // of each specimen so far
  Eigen::Index row = 0;
  for (const SourceRows& rows : sources) {
    const int number = specimens.try_emplace(rows.specimen, static_cast<int>(specimens.size())).first->second;
    for (std::size_t i = 0; i < rows.features.size(); ++i, ++row) {
      samples.features.row(row) = rows.features[i];
      samples.specimen.push_back(number);
      samples.cycle.push_back(rows.place.empty() ? ++windows[number] : rows.place[i]);
      if (samples.classes) {
        const auto found = std::ranges::find(samples.outputs, rows.classes[i]);
        samples.targets(row, found - samples.outputs.begin()) = 1.0;
        continue;
      }
      samples.targets.row(row) =
          Eigen::Map<const Eigen::RowVectorXd>(rows.targets[i].data(), samples.targets.cols());
    }
    data.sources.push_back({rows.source.string(), rows.specimen, rows.features.size()});
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

void RequireVariation(const TrainingData& data, const fs::path& first, bool campaigns) {
  for (std::size_t column = 0; column < data.samples.outputs.size(); ++column) {
    const auto values = data.samples.targets.col(static_cast<Eigen::Index>(column));
    if (!(values.maxCoeff() > values.minCoeff())) {
      Refuse(first,
             fmt::format("{} is {} in every {}", data.samples.outputs[column], values(0),
                         campaigns ? "cycle" : "record"),
             fmt::format("something that changes over the {}", campaigns ? "campaign" : "records"));
    }
    if (!data.samples.classes && (values.array() == 0.0).any()) {
      Refuse(first, fmt::format("{} is 0 in some records", data.samples.outputs[column]),
             "other than 0: errors are told as a share of it");
    }
  }
}

std::string_view BytesOf(const Eigen::MatrixXd& values) {
  return {reinterpret_cast<const char*>(values.data()),
          static_cast<std::size_t>(values.size()) * sizeof(double)};
}

void WarnOfUnknown(TrainingData& data) {
  const std::vector<std::string> names = data.recipe.envelope.WithoutRange();
  if (names.empty()) return;
  data.warnings.push_back(
      {"", 0,
       fmt::format("not every record tells {} (expected metadata or a column of that name): the "
                   "predictor cannot tell when a gear runs at another one",
                   fmt::join(names, ", "))});
}

std::vector<SourceRows> ReadCampaigns(const std::vector<fs::path>& campaigns, const SourceSettings& settings,
                                      const std::vector<std::string>& outputs,
                                      const std::function<void(double)>& progress) {
  if (outputs == std::vector<std::string>{kClassLabel}) {
    Refuse(campaigns.front(), "a campaign has no classes", "record files with a class");
  }
  std::vector<SourceRows> sources;
  for (std::size_t k = 0; k < campaigns.size(); ++k) {
    sources.push_back(
        ReadCampaignRows(campaigns[k], settings, outputs, [&](std::size_t done, std::size_t all) {
          const double share = static_cast<double>(done) / static_cast<double>(all);
          progress((static_cast<double>(k) + share) / static_cast<double>(campaigns.size()));
        }));
  }
  return sources;
}

}  // namespace

TrainingData ReadTrainingData(const std::vector<fs::path>& paths, const SourceSettings& settings,
                              SpecimenPer specimen_per,
                              const std::function<void(const std::string&, double)>& progress) {
  if (settings.outputs.size() > 1 &&
      std::ranges::find(settings.outputs, kClassLabel) != settings.outputs.end()) {
    throw BenchError(ExitCode::kWrongInput,
                     "error: class and quantities in one predictor (expected class alone, or without it)");
  }
  const MeasurementPaths sorted = SortPaths(paths);
  TrainingData data;
  data.recipe.features = settings.features;
  std::vector<SourceRows> sources;
  std::vector<std::string> outputs = settings.outputs;
  const double campaigns_share = sorted.files.empty() ? 1.0 : sorted.campaigns.empty() ? 0.0 : 0.5;
  if (!sorted.campaigns.empty()) {
    if (outputs.empty()) outputs = CampaignOutputs(sorted.campaigns.front());
    sources = ReadCampaigns(sorted.campaigns, settings, outputs,
                            [&](double share) { progress("features", campaigns_share * share); });
  }
  if (!sorted.files.empty()) {
    SourceSettings of_records = settings;
    of_records.outputs = outputs;
    if (!sources.empty()) of_records.window_s = 0.0;
    const RecordFiles records = SurveyRecords(sorted.files, of_records);
    outputs = records.outputs;
    data.warnings = records.warnings;
    data.recipe.window = records.window;
    data.recipe.decimates = records.signals.decimates;
    std::vector<SourceRows> rows =
        ReadRecordRows(records, of_records, [&](std::size_t done, std::size_t all) {
          progress("features", campaigns_share + (1.0 - campaigns_share) * static_cast<double>(done) /
                                                     static_cast<double>(all));
        });
    std::ranges::move(rows, std::back_inserter(sources));
  }
  const bool mixed = !sorted.campaigns.empty() && !sorted.files.empty();
  for (SourceRows& rows : sources) {
    // Torque is looked at to show that it says nothing new; records need not have it.
    if (mixed) KeepVibration(rows);
  }
  const SourceRows& first = sources.front();
  for (const SourceRows& rows : sources) {
    RequireLike(rows, first);
    data.notes.insert(data.notes.end(), rows.notes.begin(), rows.notes.end());
  }
  data.recipe.channels = first.shape.channels;
  data.recipe.sample_rate_hz = first.shape.sample_rate_hz;
  data.vibration_features = first.shape.vibration_features;
  data.samples.inputs = first.shape.names;
  data.samples.outputs = outputs;
  data.samples.classes = outputs == std::vector<std::string>{kClassLabel};
  const bool campaigns = !sorted.campaigns.empty();
  RequireEnough(sources, data, campaigns);
  std::erase_if(sources, [](const SourceRows& rows) { return rows.features.empty(); });
  SpecimensFound specimens = NameSpecimens(sources, specimen_per);
  data.specimens_taken_for = std::move(specimens.taken_for);
  if (!specimens.warning.empty()) data.warnings.push_back({"", 0, std::move(specimens.warning)});
  data.recipe.least_samples = std::ranges::min(sources, {}, &SourceRows::least_samples).least_samples;
  for (const SourceRows& rows : sources) data.recipe.envelope.Include(rows.operating);
  WarnOfUnknown(data);
  if (data.samples.classes) NameClasses(sources, data.samples);
  FillSamples(sources, data);
  LeaveOutUndefined(data);
  RequireVariation(data, sources.front().source, campaigns);
  data.sha256 =
      Sha256(std::string(BytesOf(data.samples.features)) + std::string(BytesOf(data.samples.targets)));
  return data;
}

}  // namespace strainwave::bench
