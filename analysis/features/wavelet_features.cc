// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/wavelet_features.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace strainwave::analysis::features {

WaveletFeatures::WaveletFeatures(WaveletRecipe recipe)
    : recipe_(std::move(recipe)), bank_(wavelets::FilterBankOf(recipe_.wavelet)) {
  if (recipe_.levels < 1 || recipe_.levels > wavelets::kMostLevels) {
    throw std::invalid_argument(
        fmt::format("levels = {} is not in 1 to {}", recipe_.levels, wavelets::kMostLevels));
  }
}

std::size_t WaveletFeatures::CountPerChannel() const {
  return static_cast<std::size_t>(recipe_.levels) * kSeriesFeatures;
}

std::vector<std::string> WaveletFeatures::Names(std::span<const std::string> channels) const {
  std::vector<std::string> names;
  names.reserve(channels.size() * CountPerChannel());
  for (const std::string& channel : channels) {
    for (int level = 1; level <= recipe_.levels; ++level) {
      for (const std::string_view column : kSeriesFeatureNames) {
        names.push_back(fmt::format("{}.a{}.{}", channel, level, column));
      }
    }
  }
  return names;
}

void WaveletFeatures::Compute(std::span<const double> signal, std::span<double> out) {
  if (out.size() != CountPerChannel()) {
    throw std::invalid_argument(
        fmt::format("out has {} places (expected {})", out.size(), CountPerChannel()));
  }
  wavelets::Decompose(signal, bank_, recipe_.border, recipe_.levels, wavelets::Details::kLeaveOut,
                      decomposition_);
  for (const std::vector<double>& series : decomposition_.approximations) {
    SeriesFeatures(series, series_, out.first<kSeriesFeatures>());
    out = out.subspan(kSeriesFeatures);
  }
}

}  // namespace strainwave::analysis::features
