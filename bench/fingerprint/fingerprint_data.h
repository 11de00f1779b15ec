// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analysis/joint_dynamics/file_splits.h"
#include "bench/fingerprint/joint_records.h"

namespace strainwave::bench {

/// Told step and share of all.
using FingerprintProgress = std::function<void(const std::string& step, double share)>;

struct FingerprintDataSettings {
  Smoothing smoothing;
  std::string healthy;      // the class that is no fault; empty: told by its name
  Eigen::Index rows{3000};  // of a file that are kept, spread evenly over it
};

/// A folder of records of joints with their classes.
struct FingerprintData {
  std::vector<JointFile> files;  // with the rows that are kept
  std::vector<std::string> names;
  std::vector<std::string> units;
  std::vector<std::string> classes;  // of each file
  std::vector<std::string> origins;  // of each file; empty where labels.csv has no such column
  std::string healthy;
  Smoothing smoothing;
  analysis::joint_dynamics::FileFacts facts;
  bool acceleration_measured{};
  std::vector<std::string> warnings;

  Eigen::Index joints() const { return files.front().motion.joints(); }
};

/// @throws BenchError (exit code 2) as ReadLabels and ReadJointFile; for an empty class or origin, one class
/// alone, a
///   healthy class that is not there, files that differ in their joints.
FingerprintData ReadFingerprintData(const std::filesystem::path& folder,
                                    const FingerprintDataSettings& settings,
                                    const FingerprintProgress& progress);

/// The class that is no fault, of all that there are: named healthy, normal and so on; else the one whose
/// files are the most, which is told in `warning`.
std::string HealthyClassOf(const std::vector<std::string>& class_of_file, std::string& warning);

}  // namespace strainwave::bench
