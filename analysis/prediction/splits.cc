// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/splits.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>

#include "analysis/shuffle.h"

namespace strainwave::analysis::prediction {
namespace {

void RequireShare(double test_share) {
  if (!(test_share > 0.0 && test_share < 1.0)) {
    throw std::invalid_argument(fmt::format("test_share = {} is not between 0 and 1", test_share));
  }
}

void RequireBothSides(const Split& split) {
  if (split.train.empty() || split.test.empty()) {
    throw std::invalid_argument(fmt::format("{} rows to train and {} to test (expected some on either side)",
                                            split.train.size(), split.test.size()));
  }
}

// The rows of each specimen in the order of its life.
std::map<int, std::vector<Eigen::Index>> Lives(std::span<const int> specimen, std::span<const double> cycle) {
  if (specimen.size() != cycle.size()) {
    throw std::invalid_argument(fmt::format("specimen has {} values, cycle has {} (expected the same number)",
                                            specimen.size(), cycle.size()));
  }
  std::map<int, std::vector<Eigen::Index>> lives;
  for (std::size_t i = 0; i < specimen.size(); ++i)
    lives[specimen[i]].push_back(static_cast<Eigen::Index>(i));
  for (auto& [number, rows] : lives) {
    std::stable_sort(rows.begin(), rows.end(), [&](Eigen::Index a, Eigen::Index b) {
      return cycle[static_cast<std::size_t>(a)] < cycle[static_cast<std::size_t>(b)];
    });
  }
  return lives;
}

// One split a fold, of rows whose fold is known.
std::vector<Split> SplitsOf(std::span<const int> fold_of_row, int folds) {
  std::vector<Split> splits(static_cast<std::size_t>(folds));
  for (int fold = 0; fold < folds; ++fold) {
    Split& split = splits[static_cast<std::size_t>(fold)];
    for (std::size_t i = 0; i < fold_of_row.size(); ++i) {
      (fold_of_row[i] == fold ? split.test : split.train).push_back(static_cast<Eigen::Index>(i));
    }
    RequireBothSides(split);
  }
  return splits;
}

}  // namespace

Split SplitByTime(std::span<const int> specimen, std::span<const double> cycle, double test_share) {
  RequireShare(test_share);
  Split split;
  for (const auto& [number, rows] : Lives(specimen, cycle)) {
    const auto tested = static_cast<std::ptrdiff_t>(static_cast<double>(rows.size()) * test_share + 0.5);
    split.train.insert(split.train.end(), rows.begin(), rows.end() - tested);
    split.test.insert(split.test.end(), rows.end() - tested, rows.end());
  }
  RequireBothSides(split);
  return split;
}

std::vector<Split> SplitsBySpecimen(std::span<const int> specimen, int folds) {
  std::map<int, int> order;
  for (const int number : specimen) order[number] = 0;
  const auto specimens = static_cast<int>(order.size());
  if (specimens < 2 || folds < 2) {
    throw std::invalid_argument(
        fmt::format("{} specimens in {} folds (expected at least two of each)", specimens, folds));
  }
  folds = std::min(folds, specimens);
  int next = 0;
  for (auto& [number, fold] : order) fold = next++ % folds;
  std::vector<int> fold_of_row;
  fold_of_row.reserve(specimen.size());
  for (const int number : specimen) fold_of_row.push_back(order[number]);
  return SplitsOf(fold_of_row, folds);
}

Split SplitAtRandom(Eigen::Index rows, double test_share, std::uint64_t seed) {
  RequireShare(test_share);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(std::max<Eigen::Index>(rows, 0)));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::mt19937_64 engine(seed);
  Shuffle(order, engine);
  const auto tested = static_cast<std::ptrdiff_t>(static_cast<double>(rows) * test_share + 0.5);
  Split split{.train = {order.begin() + tested, order.end()},
              .test = {order.begin(), order.begin() + tested}};
  RequireBothSides(split);
  return split;
}

std::vector<Split> SplitsByBlocks(std::span<const int> specimen, std::span<const double> cycle, int folds) {
  if (folds < 2 || specimen.size() < static_cast<std::size_t>(folds)) {
    throw std::invalid_argument(fmt::format(
        "{} rows in {} folds (expected two folds or more, and a row for each)", specimen.size(), folds));
  }
  // A few blocks a fold: short enough that each fold sees all ages, long enough that neighbours stay
  // together.
  constexpr std::size_t kBlocksPerFold = 4;
  std::vector<int> fold_of_row(specimen.size());
  std::size_t block = 0;
  for (const auto& [number, rows] : Lives(specimen, cycle)) {
    const std::size_t blocks = std::min(rows.size(), kBlocksPerFold * static_cast<std::size_t>(folds));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      fold_of_row[static_cast<std::size_t>(rows[i])] =
          static_cast<int>((block + i * blocks / rows.size()) % static_cast<std::size_t>(folds));
    }
    block += blocks;
  }
  return SplitsOf(fold_of_row, folds);
}

}  // namespace strainwave::analysis::prediction
