// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/features/packet_features.h"
#include "analysis/prediction/samples.h"
#include "bench/records/record_reader.h"
#include "bench/records/record_warnings.h"

namespace strainwave::bench {

/// One measurement of the system's performance.
struct SystemValue {
  Eigen::VectorXd health;  // one a component
  int unit{};
  double value{};
};

/// The signals of a cycle, for pictures.
struct MotorExample {
  int condition{};
  std::vector<std::vector<double>> channels;
};

/// A data set of cycles whose components' health is known.
struct HealthData {
  std::filesystem::path folder;
  std::vector<std::string> components;
  /// Rows are cycles; targets are the health, a column a component; specimen is the unit.
  analysis::prediction::Samples samples;
  std::vector<int> condition;  // of each row: which row of `conditions`
  std::vector<int> file;       // of each row: which of `files`
  Eigen::MatrixXd conditions;  // all that there are × components
  std::vector<std::string> units;
  std::vector<std::string> files;
  std::vector<SystemValue> system;     // none where it was not measured
  Eigen::MatrixXd failed;              // conditions that the system did not survive × components
  std::vector<MotorExample> examples;  // a cycle of each condition, of sixteen at most
  analysis::features::PacketRecipe recipe;
  double sample_rate_hz{};
  std::size_t shortest{};  // cycle, in rows
  std::size_t longest{};
  std::string cut;
  std::string sha256;  // of features and targets
  std::vector<RecordWarning> warnings;
  std::vector<std::string> notes;  // limits of this data set, in words
};

inline constexpr const char* kFailedConditions = "failed_conditions.csv";
inline constexpr const char* kHealthPrefix = "health_";

using HealthProgress = std::function<void(const std::string& step, double share)>;

/// Reads labels and records of a folder.
///
/// Columns of `labels.csv`: `health_NAME`, 0 to 1, one or more; `system_rms`, where measured (an empty cell:
/// not with this record). Values of it that are the same to the last digit within a unit and condition are
/// one measurement. A table `failed_conditions.csv` of `health_NAME` beside it tells conditions without
/// records, in which the system failed.
///
/// @throws BenchError with the place in the table: health out of range, a component that does not change, or
///   that changes with the others alone, one condition only; as FeaturesOfMotorFile; records of two rates.
HealthData ReadHealthData(const RecordReader& reader, const std::filesystem::path& folder,
                          const analysis::features::PacketRecipe& recipe, const HealthProgress& progress);

}  // namespace strainwave::bench
