// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/features/detail_deviations.h"
#include "analysis/features/envelope_orders.h"
#include "analysis/features/order_bands.h"
#include "analysis/features/packet_features.h"
#include "analysis/features/wavelet_features.h"

namespace strainwave::bench {

/// Series features of approximations, energies by order, deviations of details, orders of the envelope
/// (both for faults), packets (for health).
enum class FeatureSet { kWavelet, kOrders, kDetails, kEnvelopeOrders, kPackets };

std::string_view NameOf(FeatureSet set);
/// Whether it needs a steady speed of the input shaft.
constexpr bool IsByOrder(FeatureSet set) {
  return set == FeatureSet::kOrders || set == FeatureSet::kEnvelopeOrders;
}
/// @throws std::invalid_argument for another name than wavelet, orders, details, envelope_orders and packets.
FeatureSet FeatureSetOf(std::string_view name);

/// What the series of a channel is told by.
struct FeatureSettings {
  FeatureSet set{FeatureSet::kWavelet};
  analysis::features::WaveletRecipe wavelet;
  analysis::features::OrderBands orders;  // of energies by order, or of the envelope
  analysis::features::DetailRecipe details{};
  analysis::features::PacketRecipe packets{};
};

/// Features of one channel after another, of whichever set. Keeps its memory; one object a thread.
class ChannelFeatures {
 public:
  /// @throws std::invalid_argument for settings out of range.
  explicit ChannelFeatures(FeatureSettings settings);

  const FeatureSettings& settings() const { return settings_; }
  std::size_t CountPerChannel() const;
  /// `CHANNEL.aLEVEL.COLUMN`, `CHANNEL.orders.LOW_HIGH`, `CHANNEL.PATH.FEATURE`, or as detail_deviations.h
  /// and envelope_orders.h say.
  std::vector<std::string> Names(std::span<const std::string> channels) const;

  /// @param samples_per_turn  of the input shaft; only sets by order need it.
  /// @param out  `CountPerChannel` places.
  /// @throws std::invalid_argument if there is no speed where one is needed, or the signal is unfit.
  void Compute(std::span<const double> signal, std::optional<double> samples_per_turn, std::span<double> out);

 private:
  FeatureSettings settings_;
  analysis::features::WaveletFeatures by_wavelet_;
  analysis::features::DetailDeviations by_detail_;
  analysis::features::PacketFeatures by_packet_;
};

}  // namespace strainwave::bench
