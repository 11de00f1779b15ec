// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace strainwave::analysis::faults {

/// When nothing is decided: the most probable class is below a limit, or leads the next by less than a
/// margin, or the record lies outside what was trained on (a distance above 1). Of labels: one of them lies
/// within half the margin of its threshold.
struct UndecidedRule {
  double least_probability{0.6};
  double least_margin{0.1};
};

struct FaultDecision {
  Eigen::Index most_probable{};
  bool undecided{};
};

/// @param probability  one a class.
/// @param distance  over the limit of novelty.
/// @throws std::invalid_argument if there is no class.
FaultDecision DecideClass(const Eigen::RowVectorXd& probability, double distance, const UndecidedRule& rule);

struct LabelDecision {
  std::vector<bool> present;
  bool undecided{};
};

/// @param threshold  one a label: from it on the label is present.
/// @throws std::invalid_argument if there are other numbers of labels.
LabelDecision DecideLabels(const Eigen::RowVectorXd& probability, const Eigen::RowVectorXd& threshold,
                           double distance, const UndecidedRule& rule);

/// How records of classes were told, of those that were tested.
struct ClassScores {
  Eigen::MatrixXi confusion;  // own class × most probable one, decided or not
  std::size_t tested{};
  std::size_t undecided{};
  double accuracy{};          // of all tested, by the most probable class
  double decided_accuracy{};  // of those decided; NaN where there is none
};

/// @param targets  n × classes, 1 in one place of each row.
/// @param probability, distance  NaN in rows that were not tested.
/// @return nothing where no row was tested.
/// @throws std::invalid_argument if shapes differ.
std::optional<ClassScores> ScoreClasses(const Eigen::MatrixXd& targets, const Eigen::MatrixXd& probability,
                                        const Eigen::VectorXd& distance, const UndecidedRule& rule);

/// Of one label.
struct LabelCounts {
  std::size_t present_told{};  // present, and told
  std::size_t absent_told{};   // absent, and told all the same
  std::size_t present_missed{};
  std::size_t absent_not_told{};

  double Accuracy() const;
  double F1() const;  // NaN where the label is neither there nor told
};

struct LabelScores {
  std::vector<LabelCounts> labels;
  std::size_t tested{};
  std::size_t undecided{};
  double exact{};      // share of records all of whose labels were told right
  double one_wrong{};  // share of labels told wrong (Hamming loss)
};
std::optional<LabelScores> ScoreLabels(const Eigen::MatrixXd& targets, const Eigen::MatrixXd& probability,
                                       const Eigen::RowVectorXd& threshold, const Eigen::VectorXd& distance,
                                       const UndecidedRule& rule);

/// Of each label the threshold with the best F1 on records that the networks had not seen; the middle of all
/// that are equally good, 0.5 where none is tested.
Eigen::RowVectorXd LabelThresholds(const Eigen::MatrixXd& targets, const Eigen::MatrixXd& probability);

}  // namespace strainwave::analysis::faults
