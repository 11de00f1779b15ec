// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/packet_features.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace strainwave::analysis::features {
namespace {

constexpr int kMostBandLevels = 10;

}  // namespace

std::vector<PacketBand> PacketBands(int levels, double sample_rate_hz) {
  const std::vector<std::string> paths = wavelets::PacketPaths(levels);
  const std::vector<std::size_t> order = wavelets::FrequencyOrder(levels);
  const double width_hz = 0.5 * sample_rate_hz / static_cast<double>(paths.size());
  std::vector<PacketBand> bands(paths.size());
  for (std::size_t place = 0; place < order.size(); ++place) {
    const double low_hz = width_hz * static_cast<double>(place);
    bands[order[place]] = {paths[order[place]], place, low_hz, low_hz + width_hz};
  }
  return bands;
}

PacketFeatures::PacketFeatures(PacketRecipe recipe)
    : recipe_(std::move(recipe)), bank_(wavelets::FilterBankOf(recipe_.wavelet)) {
  if (recipe_.levels < 1 || recipe_.levels > kMostBandLevels)
    throw std::invalid_argument(
        fmt::format("levels = {} is not in 1 to {}", recipe_.levels, kMostBandLevels));
}

std::vector<std::string> PacketFeatures::Names(std::span<const std::string> channels) const {
  std::vector<std::string> names;
  for (const std::string& channel : channels) {
    for (const std::string& path : wavelets::PacketPaths(recipe_.levels)) {
      for (const std::string_view feature : kBandFeatureNames)
        names.push_back(fmt::format("{}.{}.{}", channel, path, feature));
    }
  }
  return names;
}

std::size_t PacketFeatures::Compute(std::span<const double> signal, std::span<double> out) {
  if (out.size() != CountPerChannel())
    throw std::invalid_argument(
        fmt::format("out has {} places (expected {})", out.size(), CountPerChannel()));
  wavelets::DecomposePackets(signal, bank_, recipe_.border, recipe_.levels, packets_);
  std::size_t floored = 0;
  double energy = 0.0;
  for (std::size_t leaf = 0; leaf < packets_.leaves.size(); ++leaf) {
    floored += BandFeatures(packets_.leaves[leaf], recipe_.normalised_entropy, workspace_,
                            out.subspan(leaf * kBandFeatures, kBandFeatures));
    energy += out[leaf * kBandFeatures];
  }
  // A sample that is not finite makes coefficients of every band so, and with them its energy.
  for (std::size_t i = 0; !std::isfinite(energy) && i < signal.size(); ++i) {
    if (!std::isfinite(signal[i]))
      throw std::invalid_argument(fmt::format("signal[{}] = {} is not finite", i, signal[i]));
  }
  return floored;
}

}  // namespace strainwave::analysis::features
