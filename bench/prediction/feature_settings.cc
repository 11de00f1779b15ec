// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/feature_settings.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace strainwave::bench {

namespace features = analysis::features;

std::string_view NameOf(FeatureSet set) {
  switch (set) {
    case FeatureSet::kWavelet:
      return "wavelet";
    case FeatureSet::kOrders:
      return "orders";
    case FeatureSet::kPackets:
      break;
  }
  return "packets";
}

FeatureSet FeatureSetOf(std::string_view name) {
  for (const FeatureSet set : {FeatureSet::kWavelet, FeatureSet::kOrders, FeatureSet::kPackets}) {
    if (name == NameOf(set)) return set;
  }
  throw std::invalid_argument(
      fmt::format("set = '{}' is not known (expected wavelet, orders or packets)", name));
}

ChannelFeatures::ChannelFeatures(FeatureSettings settings)
    : settings_(std::move(settings)), by_wavelet_(settings_.wavelet), by_packet_(settings_.packets) {}

std::size_t ChannelFeatures::CountPerChannel() const {
  switch (settings_.set) {
    case FeatureSet::kWavelet:
      return by_wavelet_.CountPerChannel();
    case FeatureSet::kOrders:
      return settings_.orders.edges.size() - 1;
    case FeatureSet::kPackets:
      break;
  }
  return by_packet_.CountPerChannel();
}

std::vector<std::string> ChannelFeatures::Names(std::span<const std::string> channels) const {
  switch (settings_.set) {
    case FeatureSet::kWavelet:
      return by_wavelet_.Names(channels);
    case FeatureSet::kOrders:
      return features::OrderBandNames(channels, settings_.orders);
    case FeatureSet::kPackets:
      break;
  }
  return by_packet_.Names(channels);
}

void ChannelFeatures::Compute(std::span<const double> signal, std::optional<double> samples_per_turn,
                              std::span<double> out) {
  if (settings_.set == FeatureSet::kWavelet) {
    by_wavelet_.Compute(signal, out);
    return;
  }
  if (settings_.set == FeatureSet::kPackets) {
    by_packet_.Compute(signal, out);
    return;
  }
  if (!samples_per_turn) {
    throw std::invalid_argument(
        "there is no steady speed of the input shaft (expected metadata or column input_speed_rpm, or column "
        "input_speed_rad_per_s)");
  }
  std::ranges::copy(features::OrderBandEnergies(signal, *samples_per_turn, settings_.orders), out.begin());
}

}  // namespace strainwave::bench
