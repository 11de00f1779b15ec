// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/study.h"
#include "analysis/parallel_for.h"

namespace strainwave::analysis::diagnosis {

/// How a record is held out: blocks of whole segments of samples, each in one of a few folds.
struct Folds {
  std::vector<std::size_t> block_of;  // one a sample
  std::vector<std::size_t> fold_of;   // one a sample
  std::size_t blocks{};
  std::size_t folds{};
};

/// Blocks of `length` samples (never across a segment), dealt to at most five folds so that neighbours fall
/// into different ones and no fold follows a regular pattern.
/// @throws std::invalid_argument if the record does not give two blocks.
Folds MakeFolds(std::size_t samples, std::span<const std::size_t> segments, std::size_t length);

/// Residuals of samples that the fit has not seen: each fold is predicted by a fit to the others, started
/// from `whole`. A sample without weight is left at 0.
/// @param parallel  over the folds
std::vector<double> HeldOutResiduals(const Study& study, std::span<const double> weights, const Folds& folds,
                                     const ModelFit& whole, const ParallelFor& parallel = InTurn);

double HeldOutRmse(std::span<const double> residuals, std::span<const double> weights);

/// Reduction of the RMSE from `before` to `after` (both held out), with a 95 % interval from 2000 resamples
/// of whole blocks.
/// @param more_variance  of a sample, in both: Study::FilteredOutVariance
GainEstimate EstimateGain(std::span<const double> before, std::span<const double> after,
                          std::span<const double> weights, const Folds& folds, double more_variance,
                          unsigned long long seed);

}  // namespace strainwave::analysis::diagnosis
