// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bench/prediction/feature_settings.h"
#include "bench/prediction/signal_settings.h"
#include "bench/prediction/window_sequence.h"
#include "daq/record.h"

namespace strainwave::bench {

/// The channels of a record as one reads them.
struct RecordSignals {
  std::vector<std::vector<double>> channels;
  std::optional<double> samples_per_turn;  // of the input shaft, at a steady speed that the record tells

  std::size_t rows() const { return channels.empty() ? 0 : channels.front().size(); }
};

/// @throws BenchError naming the record if a channel is missing, or the rate is another one (by more than a
///   hundredth).
RecordSignals SignalsOf(const daq::Record& record, const SignalSettings& settings);

/// Refuses a channel that is one value throughout, or stays at its highest or lowest value: a sensor that is
/// not connected, or at its end. @throws BenchError.
void RequireAlive(const daq::Record& record, const RecordSignals& signals,
                  const std::vector<std::string>& channels);

/// The features of one window, channel by channel.
/// @throws BenchError naming the record if they cannot be computed.
std::vector<double> FeaturesOfWindow(const daq::Record& record, const RecordSignals& signals,
                                     const Window& window, ChannelFeatures& features);

}  // namespace strainwave::bench
