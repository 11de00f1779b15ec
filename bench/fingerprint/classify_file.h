// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/fingerprint/train_fingerprints.h"

namespace strainwave::bench {

/// What a model says of one file of joints.
struct FileVerdict {
  std::filesystem::path file;
  double probability{};  // of a fault: mean over the samples
  /// What each joint's errors and attributions add to it, from the mean of healthy fingerprints: exact
  /// Shapley values where there are few joints. They sum to `probability` less `usual`.
  std::vector<double> attribution;
  double usual{};                   // mean probability of the healthy fingerprints
  std::vector<double> residual_Nm;  // root mean square of what the nominal network does not explain
  double outside_share{};           // of the samples, with a state out of the range of the training
  Eigen::Index samples{};
  std::vector<std::string> warnings;
};

/// @throws BenchError as ReadJointFile, and for another number of joints than the model's.
FileVerdict ClassifyFile(const FingerprintModel& model, const std::filesystem::path& path);

}  // namespace strainwave::bench
