// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace strainwave::analysis::prediction {

/// Row numbers on the two sides of a line that no record crosses.
struct Split {
  std::vector<Eigen::Index> train;
  std::vector<Eigen::Index> test;
};

/// Of each specimen the later part of its life is the test: what a predictor meets that goes on watching the
/// reducers it was trained on.
/// @param test_share  of each specimen's rows, between 0 and 1.
/// @throws std::invalid_argument if the lengths differ, the share is outside, or a side is empty.
Split SplitByTime(std::span<const int> specimen, std::span<const double> cycle, double test_share);

/// One split a fold: whole specimens are the test, so that no record of one stands on both sides. Specimens
/// are dealt out by number, `folds` of them or as many as there are specimens.
/// @throws std::invalid_argument if there are fewer than two specimens or folds.
std::vector<Split> SplitsBySpecimen(std::span<const int> specimen, int folds);

/// Rows drawn at random. It flatters: neighbours in time of each tested row are trained on.
/// @throws std::invalid_argument if a side is empty.
Split SplitAtRandom(Eigen::Index rows, double test_share, std::uint64_t seed);

/// Blocks of neighbouring rows of one specimen, dealt to the folds in turn.
/// @throws std::invalid_argument if there are fewer than two folds or fewer rows than folds.
std::vector<Split> SplitsByBlocks(std::span<const int> specimen, std::span<const double> cycle, int folds);

}  // namespace strainwave::analysis::prediction
