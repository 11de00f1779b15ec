// SPDX-License-Identifier: Apache-2.0
#include "analysis/faults/fault_scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace strainwave::analysis::faults {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

void RequireSameRows(const Eigen::MatrixXd& targets, const Eigen::MatrixXd& probability) {
  if (targets.rows() != probability.rows() || targets.cols() != probability.cols())
    throw std::invalid_argument(fmt::format("probability is {} × {} (expected {} × {}, as targets are)",
                                            probability.rows(), probability.cols(), targets.rows(),
                                            targets.cols()));
}

bool IsOutside(double distance) { return !(distance <= 1.0); }

double Ratio(std::size_t part, std::size_t whole) {
  return whole == 0 ? kNoNumber : static_cast<double>(part) / static_cast<double>(whole);
}

double F1Of(std::size_t right, std::size_t false_alarms, std::size_t missed) {
  return Ratio(2 * right, 2 * right + false_alarms + missed);
}

}  // namespace

FaultDecision DecideClass(const Eigen::RowVectorXd& probability, double distance, const UndecidedRule& rule) {
  if (probability.size() == 0) throw std::invalid_argument("probability is empty (expected one a class)");
  FaultDecision decision;
  const double most = probability.maxCoeff(&decision.most_probable);
  double next = -std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < probability.size(); ++k) {
    if (k != decision.most_probable) next = std::max(next, probability(k));
  }
  decision.undecided =
      most < rule.least_probability || most - next < rule.least_margin || IsOutside(distance);
  return decision;
}

LabelDecision DecideLabels(const Eigen::RowVectorXd& probability, const Eigen::RowVectorXd& threshold,
                           double distance, const UndecidedRule& rule) {
  if (probability.size() != threshold.size())
    throw std::invalid_argument(fmt::format("threshold has {} values (expected {}, one a label)",
                                            threshold.size(), probability.size()));
  LabelDecision decision{.present = {}, .undecided = IsOutside(distance)};
  for (Eigen::Index k = 0; k < probability.size(); ++k) {
    decision.present.push_back(probability(k) >= threshold(k));
    if (std::abs(probability(k) - threshold(k)) < 0.5 * rule.least_margin) decision.undecided = true;
  }
  return decision;
}

std::optional<ClassScores> ScoreClasses(const Eigen::MatrixXd& targets, const Eigen::MatrixXd& probability,
                                        const Eigen::VectorXd& distance, const UndecidedRule& rule) {
  RequireSameRows(targets, probability);
  ClassScores scores;
  scores.confusion = Eigen::MatrixXi::Zero(targets.cols(), targets.cols());
  std::size_t decided_right = 0;
  for (Eigen::Index row = 0; row < targets.rows(); ++row) {
    if (!std::isfinite(distance(row))) continue;
    Eigen::Index own = 0;
    targets.row(row).maxCoeff(&own);
    const FaultDecision decision = DecideClass(probability.row(row), distance(row), rule);
    ++scores.confusion(own, decision.most_probable);
    ++scores.tested;
    if (decision.undecided) {
      ++scores.undecided;
    } else if (own == decision.most_probable) {
      ++decided_right;
    }
  }
  if (scores.tested == 0) return std::nullopt;
  scores.accuracy = Ratio(static_cast<std::size_t>(scores.confusion.trace()), scores.tested);
  scores.decided_accuracy = Ratio(decided_right, scores.tested - scores.undecided);
  return scores;
}

double LabelCounts::Accuracy() const {
  return Ratio(present_told + absent_not_told, present_told + absent_not_told + absent_told + present_missed);
}

double LabelCounts::F1() const { return F1Of(present_told, absent_told, present_missed); }

std::optional<LabelScores> ScoreLabels(const Eigen::MatrixXd& targets, const Eigen::MatrixXd& probability,
                                       const Eigen::RowVectorXd& threshold, const Eigen::VectorXd& distance,
                                       const UndecidedRule& rule) {
  RequireSameRows(targets, probability);
  LabelScores scores;
  scores.labels.resize(static_cast<std::size_t>(targets.cols()));
  std::size_t exact = 0;
  std::size_t wrong = 0;
  for (Eigen::Index row = 0; row < targets.rows(); ++row) {
    if (!std::isfinite(distance(row))) continue;
    const LabelDecision decision = DecideLabels(probability.row(row), threshold, distance(row), rule);
    ++scores.tested;
    if (decision.undecided) ++scores.undecided;
    std::size_t wrong_here = 0;
    for (Eigen::Index k = 0; k < targets.cols(); ++k) {
      const bool present = targets(row, k) > 0.5;
      const bool told = decision.present[static_cast<std::size_t>(k)];
      LabelCounts& counts = scores.labels[static_cast<std::size_t>(k)];
      ++(present ? (told ? counts.present_told : counts.present_missed)
                 : (told ? counts.absent_told : counts.absent_not_told));
      if (present != told) ++wrong_here;
    }
    wrong += wrong_here;
    if (wrong_here == 0) ++exact;
  }
  if (scores.tested == 0) return std::nullopt;
  scores.exact = Ratio(exact, scores.tested);
  scores.one_wrong = Ratio(wrong, scores.tested * scores.labels.size());
  return scores;
}

Eigen::RowVectorXd LabelThresholds(const Eigen::MatrixXd& targets, const Eigen::MatrixXd& probability) {
  RequireSameRows(targets, probability);
  Eigen::RowVectorXd thresholds = Eigen::RowVectorXd::Constant(targets.cols(), 0.5);
  constexpr int kSteps = 100;
  for (Eigen::Index k = 0; k < targets.cols(); ++k) {
    double best = -1.0;
    int first = 0;
    int last = 0;
    for (int step = 1; step < kSteps; ++step) {
      const double threshold = static_cast<double>(step) / kSteps;
      std::size_t right = 0;
      std::size_t false_alarms = 0;
      std::size_t missed = 0;
      for (Eigen::Index row = 0; row < targets.rows(); ++row) {
        if (!std::isfinite(probability(row, k))) continue;
        const bool told = probability(row, k) >= threshold;
        const bool present = targets(row, k) > 0.5;
        right += present && told;
        false_alarms += !present && told;
        missed += present && !told;
      }
      const double f1 = F1Of(right, false_alarms, missed);
      if (f1 > best) {
        best = f1;
        first = step;
      }
      if (f1 == best) last = step;
    }
    if (best > 0.0) thresholds(k) = 0.5 * (first + last) / kSteps;
  }
  return thresholds;
}

}  // namespace strainwave::analysis::faults
