// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analysis/prediction/samples.h"
#include "bench/prediction/feature_recipe.h"
#include "bench/prediction/source_rows.h"
#include "bench/prediction/specimens.h"

namespace strainwave::bench {

/// A campaign or a record file that was trained on.
struct TrainingSource {
  std::string folder;
  std::string specimen;
  std::size_t records{};
};

/// Vibration features and what was measured with them, side by side.
struct TrainingData {
  analysis::prediction::Samples samples;  // features of vibration first, then of torque
  std::size_t vibration_features{};
  FeatureRecipe recipe;  // but for its inputs
  std::vector<TrainingSource> sources;
  std::string specimens_taken_for;      // specimens.h
  std::vector<std::string> notes;       // what was left out, and why
  std::vector<RecordWarning> warnings;  // about the records, and what is not known of them
  std::string sha256;                   // of all features and targets that were used
};

inline constexpr std::size_t kFewestRows = 20;

/// Reads campaign folders, record files of kind vibration with labels, and folders of such files; whatever is
/// of one specimen is one reducer (specimens.h, for records that name none). Cycles with a flagged result,
/// and features that are not finite in every row, are left out with a note.
/// @throws BenchError if a path is none of these, sources have different channels or rates, an output is in
///   none of them or is the same in all, or fewer than 20 rows are left.
TrainingData ReadTrainingData(const std::vector<std::filesystem::path>& paths, const SourceSettings& settings,
                              SpecimenPer specimen_per,
                              const std::function<void(const std::string& step, double share)>& progress);

}  // namespace strainwave::bench
