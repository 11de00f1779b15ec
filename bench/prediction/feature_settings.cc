// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/feature_settings.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace strainwave::bench {

namespace features = analysis::features;

namespace {

constexpr std::pair<FeatureSet, std::string_view> kFeatureSets[] = {
    {FeatureSet::kWavelet, "wavelet"},
    {FeatureSet::kOrders, "orders"},
    {FeatureSet::kDetails, "details"},
    {FeatureSet::kEnvelopeOrders, "envelope_orders"},
    {FeatureSet::kPackets, "packets"}};

}  // namespace

std::string_view NameOf(FeatureSet set) {
  for (const auto& [value, name] : kFeatureSets) {
    if (value == set) return name;
  }
  throw std::logic_error("a feature set without a name");
}

FeatureSet FeatureSetOf(std::string_view name) {
  for (const auto& [value, known] : kFeatureSets) {
    if (name == known) return value;
  }
  throw std::invalid_argument(fmt::format(
      "set = '{}' is not known (expected wavelet, orders, details, envelope_orders or packets)", name));
}

ChannelFeatures::ChannelFeatures(FeatureSettings settings)
    : settings_(std::move(settings)),
      by_wavelet_(settings_.wavelet),
      by_detail_(settings_.details),
      by_packet_(settings_.packets) {}

std::size_t ChannelFeatures::CountPerChannel() const {
  switch (settings_.set) {
    case FeatureSet::kWavelet:
      return by_wavelet_.CountPerChannel();
    case FeatureSet::kDetails:
      return by_detail_.CountPerChannel();
    case FeatureSet::kPackets:
      return by_packet_.CountPerChannel();
    case FeatureSet::kOrders:
    case FeatureSet::kEnvelopeOrders:
      break;
  }
  return settings_.orders.edges.size() - 1;
}

std::vector<std::string> ChannelFeatures::Names(std::span<const std::string> channels) const {
  switch (settings_.set) {
    case FeatureSet::kWavelet:
      return by_wavelet_.Names(channels);
    case FeatureSet::kDetails:
      return by_detail_.Names(channels);
    case FeatureSet::kPackets:
      return by_packet_.Names(channels);
    case FeatureSet::kOrders:
      return features::OrderBandNames(channels, settings_.orders);
    case FeatureSet::kEnvelopeOrders:
      break;
  }
  return features::EnvelopeOrderNames(channels, settings_.orders);
}

void ChannelFeatures::Compute(std::span<const double> signal, std::optional<double> samples_per_turn,
                              std::span<double> out) {
  if (settings_.set == FeatureSet::kWavelet) return by_wavelet_.Compute(signal, out);
  if (settings_.set == FeatureSet::kDetails) return by_detail_.Compute(signal, out);
  if (settings_.set == FeatureSet::kPackets) {
    by_packet_.Compute(signal, out);
    return;
  }
  if (!samples_per_turn) {
    throw std::invalid_argument(
        "there is no steady speed of the input shaft (expected metadata or column input_speed_rpm, or column "
        "input_speed_rad_per_s)");
  }
  const auto by_order =
      settings_.set == FeatureSet::kOrders ? features::OrderBandEnergies : features::EnvelopeOrderShares;
  std::ranges::copy(by_order(signal, *samples_per_turn, settings_.orders), out.begin());
}

}  // namespace strainwave::bench
