// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/heldout.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

namespace strainwave::analysis::diagnosis {

Folds MakeFolds(std::size_t samples, std::span<const std::size_t> segments, std::size_t length) {
  Folds folds;
  folds.block_of.resize(samples);
  folds.fold_of.resize(samples);
  length = std::max<std::size_t>(length, 1);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const std::size_t first = segments[s];
    const std::size_t last = s + 1 < segments.size() ? segments[s + 1] : samples;
    if (last <= first) continue;
    // Equal blocks, so that no segment ends in a splinter.
    const std::size_t here = std::max<std::size_t>(1, (last - first + length / 2) / length);
    for (std::size_t i = first; i < last; ++i) {
      folds.block_of[i] = folds.blocks + (i - first) * here / (last - first);
    }
    folds.blocks += here;
  }
  if (folds.blocks < 2) {
    throw std::invalid_argument(fmt::format(
        "the record is too short to hold anything out: {} samples, one block of {} (expected at least "
        "two blocks)",
        samples, length));
  }
  folds.folds = std::min<std::size_t>(5, folds.blocks);
  // Each round of blocks is dealt in a new order: no fold takes one and the same place of every turn.
  std::minstd_rand random(20240229);
  std::vector<std::size_t> fold_of_block(folds.blocks);
  std::array<std::size_t, 5> hand{0, 1, 2, 3, 4};
  for (std::size_t block = 0; block < folds.blocks; ++block) {
    const std::size_t place = block % folds.folds;
    if (place == 0) {
      for (std::size_t i = folds.folds - 1; i > 0; --i) std::swap(hand[i], hand[random() % (i + 1)]);
    }
    fold_of_block[block] = hand[place];
  }
  for (std::size_t i = 0; i < samples; ++i) folds.fold_of[i] = fold_of_block[folds.block_of[i]];
  return folds;
}

std::vector<double> HeldOutResiduals(const Study& study, std::span<const double> weights, const Folds& folds,
                                     const ModelFit& whole, const ParallelFor& parallel) {
  const std::span<const double> measured = study.measured();
  std::vector<double> residuals(measured.size(), 0.0);
  parallel(folds.folds, [&](std::size_t fold) {
    std::vector<double> training(weights.size());
    for (std::size_t i = 0; i < training.size(); ++i)
      training[i] = folds.fold_of[i] == fold ? 0.0 : weights[i];
    const ModelFit fit = study.Fit(whole.causes, training, &whole, FitPurpose::kCompare);
    for (std::size_t i = 0; i < training.size(); ++i) {
      if (folds.fold_of[i] != fold || !(weights[i] > 0.0)) continue;
      const double predicted =
          fit.usable ? fit.predicted(static_cast<Eigen::Index>(i)) : whole.predicted.mean();
      residuals[i] = measured[i] - predicted;
    }
  });
  return residuals;
}

double HeldOutRmse(std::span<const double> residuals, std::span<const double> weights) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (!(weights[i] > 0.0)) continue;
    sum += residuals[i] * residuals[i];
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

GainEstimate EstimateGain(std::span<const double> before, std::span<const double> after,
                          std::span<const double> weights, const Folds& folds, double more_variance,
                          unsigned long long seed) {
  std::vector<double> before_sum(folds.blocks, 0.0);
  std::vector<double> after_sum(folds.blocks, 0.0);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!(weights[i] > 0.0)) continue;
    before_sum[folds.block_of[i]] += before[i] * before[i] + more_variance;
    after_sum[folds.block_of[i]] += after[i] * after[i] + more_variance;
  }
  const auto reduction = [](double from, double to) { return from > 0.0 ? 1.0 - std::sqrt(to / from) : 0.0; };
  double all_before = 0.0;
  double all_after = 0.0;
  for (std::size_t b = 0; b < folds.blocks; ++b) {
    all_before += before_sum[b];
    all_after += after_sum[b];
  }
  GainEstimate gain;
  gain.reduction = reduction(all_before, all_after);
  constexpr int kResamples = 2000;
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> pick(0, folds.blocks - 1);
  std::vector<double> reductions;
  reductions.reserve(kResamples);
  for (int r = 0; r < kResamples; ++r) {
    double from = 0.0;
    double to = 0.0;
    for (std::size_t b = 0; b < folds.blocks; ++b) {
      const std::size_t chosen = pick(random);
      from += before_sum[chosen];
      to += after_sum[chosen];
    }
    reductions.push_back(reduction(from, to));
  }
  std::sort(reductions.begin(), reductions.end());
  gain.low = reductions[kResamples / 40];
  gain.high = reductions[kResamples - 1 - kResamples / 40];
  return gain;
}

}  // namespace strainwave::analysis::diagnosis
