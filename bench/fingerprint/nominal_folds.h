// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/joint_dynamics/attribution.h"
#include "analysis/joint_dynamics/classification.h"
#include "analysis/joint_dynamics/nominal.h"

namespace strainwave::bench {

/// Fingerprints by nominal networks that have seen neither the file whose fingerprint it is nor, of a split,
/// what its fold leaves out: not in their training, and not through the labels that say which files are
/// healthy.
///
/// Of a split with folds, the fingerprints of the files in fold k come from a network of the healthy files of
/// all others; those that a classifier learns from, of the files in fold j, from a network of all but j and
/// k. Where there are fewer than four folds, the files outside of k are dealt to folds by unit once more.
struct NominalFolds {
  /// By split, as ScoreSplits takes them; that of random samples has one network of all healthy files, which
  /// has seen what is tested.
  std::map<std::string, analysis::joint_dynamics::SampleFeatures> features;
  std::map<std::string, std::string> impossible;          // why a split has none
  std::optional<analysis::prediction::Ensemble> nominal;  // of all healthy files
  Eigen::MatrixXd background;                             // its states
  int networks{};
  double worst_gap{};  // of the attributions
  double mean_standard_error{};
};

struct NominalSettings {
  analysis::joint_dynamics::DynamicsSettings training;
  analysis::joint_dynamics::AttributionSettings attribution;
  // Of healthy files that a network is trained on: so many of each, but no fewer and no more than these of all.
  Eigen::Index rows_of_file{300};
  Eigen::Index fewest_rows{4000};
  Eigen::Index most_rows{20000};
  Eigen::Index background{25};  // rows
};

/// Spread evenly over the files.
/// @param motion   of each file, rows to train on.
/// @param samples  of each file, rows whose fingerprints are made.
NominalFolds MakeNominalFolds(const std::vector<analysis::joint_dynamics::FileSplit>& splits,
                              const analysis::joint_dynamics::FileFacts& facts,
                              const std::vector<analysis::joint_dynamics::JointMotion>& motion,
                              const std::vector<analysis::joint_dynamics::JointMotion>& samples,
                              const NominalSettings& settings, const analysis::ParallelFor& parallel,
                              const std::function<void(double share)>& progress);

/// States of some files, as many as `rows` in all, each with an equal part.
Eigen::MatrixXd BackgroundOf(const std::vector<analysis::joint_dynamics::JointMotion>& motion,
                             const std::vector<std::size_t>& files, Eigen::Index rows);

}  // namespace strainwave::bench
