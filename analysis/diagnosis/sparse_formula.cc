// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/sparse_formula.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "analysis/diagnosis/stability_selection.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr std::size_t kFewestForFormula = 100;
constexpr std::size_t kFewestBlocks = 24;
constexpr std::size_t kMostBlocks = 96;
constexpr std::size_t kFolds = 5;
constexpr double kWorthSaying = 0.01;  // of the variance, on held-out blocks

// What a formula is looked for in.
struct Task {
  const Study& study;
  const Eigen::VectorXd& residual;
  std::vector<std::size_t> block_of;
  std::vector<std::size_t> fold_of_block;
  bool with_lines{};
};

struct Choice {
  SparseProblem problem;
  std::vector<std::size_t> terms;
  Eigen::VectorXd numbers;
  Eigen::VectorXd predicted;
};

Choice Choose(const Task& task, std::span<const double> weights, int pairs, unsigned long long seed) {
  const std::size_t blocks = task.fold_of_block.size();
  const std::span<const double> samples(task.residual.data(), weights.size());
  Choice choice;
  choice.problem = SumUp(BuildLibrary(task.study, samples, weights, task.with_lines), task.residual, weights,
                         task.block_of, blocks);
  choice.predicted = Eigen::VectorXd::Zero(task.residual.size());
  std::vector<char> has_weight(blocks, 0);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > 0.0) has_weight[task.block_of[i]] = 1;
  }
  std::vector<std::size_t> used;
  for (std::size_t b = 0; b < blocks; ++b) {
    if (has_weight[b] != 0) used.push_back(b);
  }
  if (used.size() < kFewestBlocks / 2 || choice.problem.terms.empty()) return choice;
  choice.terms = StableTerms(choice.problem, used, pairs, seed);
  if (choice.terms.empty()) return choice;
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), task.residual.size());
  choice.numbers = SparseCoefficients(choice.problem, choice.terms, used, w.dot(task.residual) / w.sum());
  choice.predicted.setConstant(choice.numbers(choice.numbers.size() - 1));
  Index first = 0;
  for (const std::size_t t : choice.terms) {
    const Eigen::MatrixXd& columns = choice.problem.terms[t].columns;
    choice.predicted += columns * choice.numbers.segment(first, columns.cols());
    first += columns.cols();
  }
  return choice;
}

// Share of the variance that choice and fit on other blocks predict.
double HeldOutShare(const Task& task, std::span<const double> weights, unsigned long long seed) {
  constexpr int kPairs = 15;
  double before = 0.0;
  double after = 0.0;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<double> training(weights.begin(), weights.end());
    for (std::size_t i = 0; i < training.size(); ++i) {
      if (task.fold_of_block[task.block_of[i]] == fold) training[i] = 0.0;
    }
    const Choice trained = Choose(task, training, kPairs, seed + fold + 1);
    for (std::size_t i = 0; i < training.size(); ++i) {
      if (task.fold_of_block[task.block_of[i]] != fold) continue;
      const double measured = task.residual(static_cast<Index>(i));
      const double left = measured - trained.predicted(static_cast<Index>(i));
      before += weights[i] * measured * measured;
      after += weights[i] * left * left;
    }
  }
  return before > 0.0 ? 1.0 - after / before : 0.0;
}

std::string FormulaText(const Choice& choice, const Study& study, double smallest) {
  std::string text;
  const auto append = [&](std::string piece) {
    const bool negative = piece.starts_with('-');
    if (negative) piece.erase(0, 1);
    text += text.empty() ? (negative ? "-" : "") : (negative ? " - " : " + ");
    text += piece;
  };
  Index first = 0;
  for (const std::size_t t : choice.terms) {
    const LibraryTerm& term = choice.problem.terms[t];
    const Eigen::VectorXd part = choice.numbers.segment(first, term.columns.cols()) * study.unit_per_si();
    append(term.describe({part.data(), static_cast<std::size_t>(part.size())}));
    first += term.columns.cols();
  }
  const double constant = choice.numbers(choice.numbers.size() - 1);
  if (std::abs(constant) > smallest) append(fmt::format("{:.3g}", constant * study.unit_per_si()));
  return fmt::format("residual / {} = {}", study.unit(), text);
}

}  // namespace

SparseFormula ProposeFormula(const Study& study, const Eigen::VectorXd& residual,
                             std::span<const double> weights, unsigned long long seed) {
  constexpr int kPairs = 50;
  // A line over an angle imitates much that is periodic for another reason: it has to be clearly better.
  constexpr double kMoreThanBefore = 1.1;
  const auto n = static_cast<std::size_t>(residual.size());
  const auto used = static_cast<std::size_t>(
      std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0.0; }));
  if (used < kFewestForFormula) return {};
  const std::size_t blocks =
      std::clamp(n / std::max<std::size_t>(1, study.BlockLength()), kFewestBlocks, kMostBlocks);
  Task task{study, residual, std::vector<std::size_t>(n), std::vector<std::size_t>(blocks), false};
  for (std::size_t i = 0; i < n; ++i) task.block_of[i] = i * blocks / n;
  for (std::size_t b = 0; b < blocks; ++b) task.fold_of_block[b] = b % kFolds;
  std::mt19937_64 engine(seed);
  for (std::size_t b = blocks - 1; b > 0; --b) {
    std::swap(task.fold_of_block[b], task.fold_of_block[engine() % (b + 1)]);
  }

  SparseFormula result;
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), residual.size());
  const double typical = std::sqrt(w.dot(residual.cwiseAbs2()) / w.sum());
  for (const bool with_lines : {false, true}) {
    task.with_lines = with_lines;
    const Choice choice = Choose(task, weights, kPairs, seed);
    if (choice.terms.empty()) continue;
    const double share = HeldOutShare(task, weights, seed);
    if (share < kWorthSaying || share < kMoreThanBefore * result.heldout_share) continue;
    result.heldout_share = share;
    result.formula = FormulaText(choice, study, 0.05 * typical);
  }
  if (result.formula.empty()) return {};
  result.sentence = fmt::format(
      "A formula that describes {:.0f} % of the variance left, on blocks that it was not chosen on: {}. It "
      "comes "
      "from a search over many functions and says nothing about the physical cause.",
      100.0 * result.heldout_share, result.formula);
  return result;
}

}  // namespace strainwave::analysis::diagnosis
