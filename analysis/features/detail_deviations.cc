// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/detail_deviations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "analysis/features/sums.h"

namespace strainwave::analysis::features {
namespace {

constexpr double kLeastShare = 1e-6;  // of the signal's own deviation

double DeviationOf(std::span<const double> values) {
  const auto count = static_cast<double>(values.size());
  const double mean = PairwiseSum(values) / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / (count - 1.0));
}

}  // namespace

int MostDetailLevels(std::size_t samples, std::size_t filter_length) {
  int levels = 0;
  // samples / (F − 1) ≥ 2^levels, without a rounded logarithm.
  for (std::size_t needed = 2 * (filter_length - 1); needed <= samples && levels < wavelets::kMostLevels;
       needed *= 2)
    ++levels;
  return levels;
}

DetailDeviations::DetailDeviations(DetailRecipe recipe)
    : recipe_(std::move(recipe)), bank_(wavelets::FilterBankOf(recipe_.wavelet)) {
  if (recipe_.levels < 1 || recipe_.levels > wavelets::kMostLevels)
    throw std::invalid_argument(
        fmt::format("levels = {} is not in 1 to {}", recipe_.levels, wavelets::kMostLevels));
}

std::vector<std::string> DetailDeviations::Names(std::span<const std::string> channels) const {
  std::vector<std::string> names;
  for (const std::string& channel : channels) {
    for (int level = 1; level <= recipe_.levels; ++level)
      names.push_back(
          fmt::format("{}.d{}.{}standard_deviation", channel, level, recipe_.logarithm ? "log_" : ""));
  }
  return names;
}

void DetailDeviations::Rebuild(std::size_t level, std::size_t samples) {
  coarse_.assign(decomposition_.approximations[level].size(), 0.0);
  for (std::size_t at = level + 1; at-- > 0;) {
    const std::vector<double>& own = decomposition_.details[at];
    if (at != level) zeros_.assign(own.size(), 0.0);
    fine_.resize(wavelets::SampleCount(coarse_.size(), bank_.length(), recipe_.border));
    wavelets::InverseTransform(coarse_, at == level ? own : zeros_, bank_, recipe_.border, fine_);
    // An odd length comes back one longer.
    fine_.resize(at == 0 ? samples : decomposition_.details[at - 1].size());
    std::swap(coarse_, fine_);
  }
}

void DetailDeviations::Compute(std::span<const double> signal, std::span<double> out) {
  if (out.size() != CountPerChannel())
    throw std::invalid_argument(
        fmt::format("out has {} places (expected {})", out.size(), CountPerChannel()));
  if (signal.size() < 2)
    throw std::invalid_argument(fmt::format("signal has {} samples (expected two or more)", signal.size()));
  wavelets::Decompose(signal, bank_, recipe_.border, recipe_.levels, wavelets::Details::kKeep,
                      decomposition_);
  const double least = std::max(kLeastShare * DeviationOf(signal), std::numeric_limits<double>::min());
  for (std::size_t level = 0; level < out.size(); ++level) {
    Rebuild(level, signal.size());
    const double deviation = std::max(DeviationOf(coarse_), least);
    out[level] = recipe_.logarithm ? std::log(deviation) : deviation;
  }
}

std::vector<double> DetailDeviations::Detail(std::span<const double> signal, int level) {
  if (level < 1 || level > recipe_.levels)
    throw std::invalid_argument(fmt::format("level = {} is not in 1 to {}", level, recipe_.levels));
  wavelets::Decompose(signal, bank_, recipe_.border, recipe_.levels, wavelets::Details::kKeep,
                      decomposition_);
  Rebuild(static_cast<std::size_t>(level - 1), signal.size());
  return coarse_;
}

}  // namespace strainwave::analysis::features
