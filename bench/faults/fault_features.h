// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "bench/data_sets/labels.h"
#include "bench/faults/fault_labels.h"
#include "bench/prediction/feature_recipe.h"
#include "bench/records/record_reader.h"
#include "bench/records/record_warnings.h"

namespace strainwave::bench {

/// One set of features of all records.
struct FaultTable {
  FeatureSettings settings;
  std::vector<std::string> names;
  Eigen::MatrixXd values;       // records × names
  int turns{};                  // of those by order: whole turns of the shortest record
  std::size_t least_samples{};  // of a record; of those by order, of so many turns
};

/// What was read of the records.
struct FaultRecords {
  FaultLabels labels;              // of the records, a row each
  std::vector<std::string> files;  // one a row, as the table names it
  std::vector<std::string> channels;
  double sample_rate_hz{};
  bool decimates{};
  std::vector<FaultTable> tables;  // the deviations of details first; then, where speeds are known, by order
  std::vector<FaultTable> other_wavelets;
  std::vector<std::string> notes;  // what was left out or not used, and why
  std::vector<RecordWarning> warnings;
};

/// Told how many files of how many are read; false ends it with prediction::TrainingEnded.
using FaultReadingProgress = std::function<bool(std::size_t done, std::size_t all)>;

/// Reads the records of the chosen rows. Their channels and rate are those of the first record; a whole
/// multiple of its rate is brought down to it, a dead sensor has its record left out with a note. Details
/// have as many levels as asked for, or as fit into the shortest record.
/// @param other_wavelets  by which details are taken, too.
/// @param speed_rpm  of each row of the table, where it is known beside the records.
/// @throws BenchError, RecordError for records that do not fit together, too few of them, or too short ones.
FaultRecords ReadFaultRecords(const Labels& table, FaultLabels labels,
                              const analysis::features::DetailRecipe& details,
                              const std::vector<std::string>& other_wavelets,
                              const std::vector<double>& speed_rpm, const RecordReader& reader,
                              const FaultReadingProgress& progress);

/// Turns of the shaft in samples at a rate, where the record or the caller knows a steady speed.
std::optional<double> SamplesPerTurnOf(const daq::Record& record, double rate_hz,
                                       std::optional<double> speed_rpm);

}  // namespace strainwave::bench
