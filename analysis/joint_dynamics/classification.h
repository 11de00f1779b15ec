// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/joint_dynamics/file_splits.h"
#include "analysis/parallel_for.h"
#include "analysis/prediction/binary_classifier.h"

namespace strainwave::analysis::joint_dynamics {

/// How well one kind of classifier did on one split.
struct SplitScore {
  double accuracy{};
  double area_under_curve{};
  double low{};  // of the accuracy, 95 %
  double high{};
  /// Files where whole files are left out: the samples of a file are no independent cases. A file counts as
  /// what the mean of its samples' scores says. Samples where samples are dealt, and then the interval is too
  /// narrow.
  std::size_t cases{};
  double sample_accuracy{};
  Eigen::MatrixXi confusion;  // of the cases, 2 × 2: own class, given class
  std::vector<double> score;  // of each case
  std::vector<int> actual;    // of each case
};

/// By split, then by kind (`prediction::NameOf`).
using ScoreTable = std::map<std::string, std::map<std::string, SplitScore>>;

/// Features of all samples: one matrix for all folds, or one a fold where they depend on what was trained on.
struct SampleFeatures {
  std::vector<Eigen::MatrixXd> of_fold;

  const Eigen::MatrixXd& For(int fold) const {
    return of_fold.size() == 1 ? of_fold.front() : of_fold.at(static_cast<std::size_t>(fold));
  }
};

/// Trains and tests each kind on each split that is possible.
/// @param features  by name of the split; "" for every other one.
/// @param file      of each sample.
/// @param faulty    of each file, as the classifiers learn it.
ScoreTable ScoreSplits(const std::vector<FileSplit>& splits,
                       const std::map<std::string, SampleFeatures>& features, const std::vector<int>& file,
                       const std::vector<int>& faulty, const std::vector<prediction::BinaryKind>& kinds,
                       const prediction::BinarySettings& settings, const ParallelFor& parallel = InTurn);

/// The kind under which `ScoreExcessFriction` stands in a table.
inline constexpr const char* kExcessFriction = "excess_friction";

/// How well the greatest excess friction of a file tells faulty ones (excess_friction.h). It learns from
/// healthy files alone; scores are over the limit, so that above 1 a file counts as faulty. Splits that deal
/// samples, and those with fewer than `kFewestHealthyFiles` healthy files outside of a fold, are left out.
/// @param nominal  nominal fingerprints of all samples, by name of the split.
ScoreTable ScoreExcessFriction(const std::vector<FileSplit>& splits,
                               const std::map<std::string, SampleFeatures>& nominal,
                               const std::vector<int>& file, const std::vector<int>& faulty,
                               Eigen::Index joints);

}  // namespace strainwave::analysis::joint_dynamics
