// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/reducer_baseline.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/errors/bench_error.h"
#include "bench/prediction/measurement_paths.h"
#include "bench/prediction/record_features.h"
#include "bench/prediction/source_rows.h"

namespace strainwave::bench {
namespace {

std::vector<SourceRows> RowsOf(const MeasurementPaths& paths, const FeatureRecipe& recipe,
                               const std::vector<std::string>& outputs) {
  SourceSettings settings;
  settings.features = recipe.features;
  settings.motor_torque = HasMotorTorque(recipe.channels);
  std::vector<SourceRows> sources;
  for (const auto& campaign : paths.campaigns)
    sources.push_back(ReadCampaignRows(campaign, settings, outputs, {}));
  if (!paths.files.empty()) {
    std::ranges::move(ReadRecordRows({.files = paths.files,
                                      .outputs = outputs,
                                      .signals = recipe.signals(),
                                      .window = recipe.window,
                                      .warnings = {}},
                                     settings, {}),
                      std::back_inserter(sources));
  }
  return sources;
}

}  // namespace

ReducerBaseline ReadReducerBaseline(const std::vector<std::filesystem::path>& paths,
                                    const FeatureRecipe& recipe, const std::vector<std::string>& outputs) {
  if (recipe.baseline_records == 0) {
    throw BenchError(ExitCode::kWrongInput,
                     "error: the predictor takes no baseline (expected one trained with --baseline)");
  }
  ReducerBaseline baseline{
      .specimen = {}, .records = recipe.baseline_records, .recipe = recipe, .outputs = outputs, .means = {}};
  const auto count = static_cast<Eigen::Index>(recipe.baseline_records);
  Eigen::MatrixXd features;
  Eigen::MatrixXd values(count, static_cast<Eigen::Index>(outputs.size()));
  Eigen::Index row = 0;
  std::vector<std::string> notes;
  for (const SourceRows& rows : RowsOf(SortPaths(paths), recipe, outputs)) {
    notes.insert(notes.end(), rows.notes.begin(), rows.notes.end());
    if (rows.shape.sample_rate_hz != recipe.sample_rate_hz) {
      Refuse(rows.source, fmt::format("the sampling rate is {} Hz", rows.shape.sample_rate_hz),
             fmt::format("{} Hz, as in training", recipe.sample_rate_hz));
    }
    // A record file that names no specimen is of the reducer that it was given for.
    const bool named = !rows.specimen.empty();
    if (named && !baseline.specimen.empty() && rows.specimen != baseline.specimen) {
      Refuse(rows.source, fmt::format("records of {} and {}", baseline.specimen, rows.specimen),
             "those of one reducer");
    }
    if (named) baseline.specimen = rows.specimen;
    baseline.recipe.inputs = rows.shape.names;
    features.conservativeResize(count, static_cast<Eigen::Index>(rows.shape.names.size()));
    for (std::size_t i = 0; i < rows.features.size() && row < count; ++i, ++row) {
      features.row(row) = rows.features[i];
      values.row(row) = Eigen::Map<const Eigen::RowVectorXd>(rows.targets[i].data(), values.cols());
    }
  }
  if (row < count) {
    Refuse(paths.front(),
           fmt::format("{} records with vibration and {}{}", row, fmt::join(outputs, ", "),
                       notes.empty() ? "" : "; " + notes.front()),
           fmt::format("at least the {} of the baseline", count));
  }
  baseline.means = analysis::prediction::BaselineOf(features, values);
  return baseline;
}

}  // namespace strainwave::bench
