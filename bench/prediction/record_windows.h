// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bench/prediction/feature_settings.h"
#include "daq/record.h"

namespace strainwave::bench {

/// How long a window of a record is: so many turns of the input shaft where `turns` is not 0, each record's
/// own number of samples; else so many samples; with both 0 the record is one window.
struct WindowLength {
  std::size_t samples{};
  int turns{};

  bool operator==(const WindowLength&) const = default;
};

struct Window {
  std::size_t begin{};
  std::size_t count{};
};

/// Windows without overlap, from the first sample on; what is left at the end is not used. None where the
/// record is shorter than one window.
/// @param samples_per_turn  of the input shaft; needed where the length is in turns.
std::vector<Window> WindowsOf(std::size_t rows, std::optional<double> samples_per_turn,
                              const WindowLength& length);

/// Which channels of a record are taken, and at what rate.
struct SignalSettings {
  std::vector<std::string> channels;  // in this order
  double sample_rate_hz{};
  bool decimates{};  // a whole multiple of the rate is brought down to it
};

/// The channels of a record as one reads them.
struct RecordSignals {
  std::vector<std::vector<double>> channels;
  std::optional<double> samples_per_turn;  // of the input shaft, at a steady speed that the record tells

  std::size_t rows() const { return channels.empty() ? 0 : channels.front().size(); }
};

/// @throws CampaignError naming the record if a channel is missing, or the rate is another one (by more than
/// a
///   hundredth).
RecordSignals SignalsOf(const daq::Record& record, const SignalSettings& settings);

/// Refuses a channel that is one value throughout, or stays at its highest or lowest value: a sensor that is
/// not connected, or at its end. @throws CampaignError.
void RequireAlive(const daq::Record& record, const RecordSignals& signals,
                  const std::vector<std::string>& channels);

/// The features of one window, channel by channel.
/// @throws CampaignError naming the record if they cannot be computed.
std::vector<double> FeaturesOfWindow(const daq::Record& record, const RecordSignals& signals,
                                     const Window& window, ChannelFeatures& features);

}  // namespace strainwave::bench
