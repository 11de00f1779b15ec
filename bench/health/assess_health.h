// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/health/what_if.h"
#include "bench/health/health_file.h"
#include "bench/records/record_reader.h"

namespace strainwave::bench {

/// What a model says of one file: of the mean of its cycles.
struct HealthAssessment {
  std::string file;
  Eigen::Index cycles{};
  std::vector<analysis::health::Bounded> health;  // one a component; may leave 0 to 1, as networks do
  std::optional<analysis::health::Bounded> system;
  bool outside_training{};       // its features lie further off than those of training
  double distance{};             // over the limit
  bool extrapolated{};           // the system: outside the conditions that were measured
  bool near_failed_condition{};  // no measured condition lies between it and one that failed
  std::vector<RecordWarning> warnings;
};

/// The system's interval holds the uncertainty of the surface, of a new measurement where that is asked for,
/// and of the components' health, by draws of a fixed seed.
HealthAssessment AssessHealth(const HealthModel& model, const RecordReader& reader,
                              const std::filesystem::path& file, analysis::health::IntervalOf interval);

/// The record files that a user named: files, the files that `labels.csv` of a folder names, else all .csv,
/// .h5 and .hdf5 files below a folder.
std::vector<std::filesystem::path> HealthPaths(const std::vector<std::string>& paths);

/// Whether a state lies beyond the convex hull of what was measured, nearer to a condition that failed than
/// to any that was measured.
bool NearFailedCondition(const HealthModel& model, const Eigen::VectorXd& state);

}  // namespace strainwave::bench
