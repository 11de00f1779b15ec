// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/resampled_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "analysis/diagnosis/residuals.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kWarmUp = 500;  // samples before the first, so that the noise has forgotten its start

bool BeginsSegment(std::span<const std::size_t> segments, std::size_t sample) {
  return std::ranges::binary_search(segments, sample);
}

}  // namespace

ResampledNoise::ResampledNoise(const Study& study, const ModelFit& fit, std::span<const double> weights)
    : study_(study), series_(study.NoiseSeries().begin(), study.NoiseSeries().end()) {
  const std::vector<double> residual = ResidualsOf(study, fit);
  double scale = 0.0;
  for (const double value : study.measured()) scale = std::max(scale, std::abs(value));
  scale = std::max(scale, 1e-300);
  for (const double weight : weights) roots_.push_back(std::sqrt(weight));
  const int order = study.LargestNoiseOrder();
  own_ = FitNoise(residual, weights, study.segments(), order, scale, study.NoiseSeries());
  decorrelated_ = FitNoise(study.Decorrelated(residual, weights), weights, study.segments(), order, scale,
                           study.NoiseSeries());
  if (series_.empty()) series_ = {0};
  series_.push_back(residual.size());
  together_ = series_.size() > 2;
  for (std::size_t s = 0; s + 1 < series_.size(); ++s)
    together_ = together_ && series_[s + 1] - series_[s] == series_[1] - series_[0];

  std::vector<double> innovations = Innovations(residual, own_);
  const std::size_t length = series_[1] - series_[0];
  if (together_) {
    for (std::size_t i = 0; i < length; ++i) {
      bool known = true;
      for (std::size_t s = 0; s + 1 < series_.size(); ++s)
        known = known && std::isfinite(innovations[series_[s] + i]);
      for (std::size_t s = 0; s + 1 < series_.size() && !known; ++s)
        innovations[series_[s] + i] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  // A fit takes its share of the noise away.
  const auto samples = static_cast<double>(own_.samples);
  const double freedom = std::max(0.5 * samples, samples - fit.charged_parameters());
  const double larger = freedom > 0.0 ? std::sqrt(samples / freedom) : 1.0;
  pool_.resize(series_.size() - 1);
  for (std::size_t s = 0; s + 1 < series_.size(); ++s) {
    for (std::size_t i = series_[s]; i < series_[s + 1]; ++i)
      if (std::isfinite(innovations[i])) pool_[s].push_back(larger * innovations[i]);
    if (pool_[s].empty()) pool_[s].push_back(0.0);
    const double mean =
        std::accumulate(pool_[s].begin(), pool_[s].end(), 0.0) / static_cast<double>(pool_[s].size());
    for (double& value : pool_[s]) value -= mean;
  }
}

const Autoregression& ResampledNoise::SeriesOf(const NoiseFit& noise, std::size_t series) const {
  static const Autoregression kNone;
  return noise.series.empty() ? kNone : noise.series[std::min(series, noise.series.size() - 1)];
}

// Weighted values less what those before them predict; not a number where one of them has no weight or is of
// another segment.
std::vector<double> ResampledNoise::Innovations(std::span<const double> values, const NoiseFit& noise) const {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> innovations(values.size(), kUnknown);
  for (std::size_t s = 0; s + 1 < series_.size(); ++s) {
    const std::vector<double>& coefficients = SeriesOf(noise, s).coefficients;
    std::size_t known = 0;  // samples in a row
    for (std::size_t i = series_[s]; i < series_[s + 1]; ++i) {
      if (BeginsSegment(study_.segments(), i)) known = 0;
      if (roots_[i] == 0.0) {
        known = 0;
        continue;
      }
      if (known++ < coefficients.size()) continue;
      innovations[i] = roots_[i] * values[i];
      for (std::size_t k = 0; k < coefficients.size(); ++k)
        innovations[i] -= coefficients[k] * roots_[i - 1 - k] * values[i - 1 - k];
    }
  }
  return innovations;
}

std::vector<double> ResampledNoise::Draw(std::uint64_t draw) const {
  std::vector<double> noise(roots_.size());
  for (std::size_t s = 0; s + 1 < series_.size(); ++s) {
    // The same engine for each: the same instants, where the series go together.
    std::seed_seq seed{static_cast<std::uint32_t>(draw), static_cast<std::uint32_t>(draw >> 32U),
                       static_cast<std::uint32_t>(together_ ? 0 : s)};
    std::mt19937_64 random(seed);
    const std::vector<double>& pool = pool_[s];
    const std::vector<double>& coefficients = SeriesOf(own_, s).coefficients;
    std::vector<double> before(coefficients.size(), 0.0);  // the newest first
    const auto next = [&] {
      double value = pool[random() % pool.size()];
      for (std::size_t k = 0; k < before.size(); ++k) value += coefficients[k] * before[k];
      if (!before.empty()) {
        std::rotate(before.begin(), before.end() - 1, before.end());
        before.front() = value;
      }
      return value;
    };
    const auto warm_up = [&] {
      for (std::size_t i = 0; i < kWarmUp && !coefficients.empty(); ++i) next();
    };
    for (std::size_t i = series_[s]; i < series_[s + 1]; ++i) {
      if (BeginsSegment(study_.segments(), i)) warm_up();
      noise[i] = next() / (roots_[i] > 0.0 ? roots_[i] : 1.0);
    }
  }
  return noise;
}

double ResampledNoise::MatchedFilterSigma(std::vector<double> effect) const {
  std::vector<double> weights;
  for (const double root : roots_) weights.push_back(root * root);
  effect = study_.Decorrelated(std::move(effect), weights);
  const std::vector<double> whitened = Innovations(effect, decorrelated_);
  double square = 0.0;
  for (std::size_t s = 0; s + 1 < series_.size(); ++s) {
    const double sd = SeriesOf(decorrelated_, s).innovation_sd;
    for (std::size_t i = series_[s]; i < series_[s + 1]; ++i)
      if (std::isfinite(whitened[i])) square += std::pow(whitened[i] / sd, 2);
  }
  return std::sqrt(square);
}

}  // namespace strainwave::analysis::diagnosis
