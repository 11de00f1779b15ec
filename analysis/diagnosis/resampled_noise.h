// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/diagnosis/noise_likelihood.h"
#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// Noise like that which a fit leaves of a study's records: autoregressive as fitted, its innovations drawn
/// anew, with replacement, from those of the residual itself (model-based resampling;
/// [Davison](docs/sources.md#davison-1997), section 8.2). Where a sample weighs less, it has the larger noise
/// that this means; channels that share noise share the instants that are drawn.
class ResampledNoise {
 public:
  /// @param weights  one a sample; those without weight are no part of what is drawn from
  ResampledNoise(const Study& study, const ModelFit& fit, std::span<const double> weights);

  /// One value a sample, SI; the same for the same draw.
  std::vector<double> Draw(std::uint64_t draw) const;

  /// How many standard errors an effect of this shape stands out of the noise where its amount alone is
  /// unknown: the norm of the whitened effect over the innovations' standard deviation
  /// ([Turin](docs/sources.md#turin-1960)). Infinite where there is no noise.
  /// @param effect  one a sample, SI, beside the model that was fitted
  double MatchedFilterSigma(std::vector<double> effect) const;

  /// Standard deviation of the innovations of samples of weight one, SI.
  double innovation_sd() const { return own_.innovation_sd; }

 private:
  const Autoregression& SeriesOf(const NoiseFit& noise, std::size_t series) const;
  std::vector<double> Innovations(std::span<const double> values, const NoiseFit& noise) const;

  const Study& study_;
  std::vector<double> roots_;              // of the weights
  std::vector<std::size_t> series_;        // first samples, and the number of samples
  NoiseFit own_;                           // of the residual as it is
  NoiseFit decorrelated_;                  // of what channels share taken apart
  std::vector<std::vector<double>> pool_;  // centred innovations to draw from, a list a series
  bool together_{};                        // one instant is drawn for all series
};

}  // namespace strainwave::analysis::diagnosis
