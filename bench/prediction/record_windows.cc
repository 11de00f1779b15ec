// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/record_windows.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/features/decimation.h"
#include "analysis/units.h"
#include "bench/prediction/record_features.h"
#include "bench/records/record_refusal.h"

namespace strainwave::bench {
RecordSignals SignalsOf(const daq::Record& record, const SignalSettings& settings) {
  const double rate_hz = SampleRateOf_hz(record);
  const int factor = DecimationFactor(rate_hz, settings);
  if (factor == 0) throw RecordRefusal(record, RateFault(rate_hz, settings).text);
  RecordSignals signals;
  for (const std::string& channel : settings.channels) {
    if (record.FindColumn(channel) == nullptr) {
      throw RecordRefusal(record, MissingChannel(channel, settings).text);
    }
    std::vector<double> signal = record.CopyAsDoubles(channel);
    signals.channels.push_back(factor == 1 ? std::move(signal)
                                           : analysis::features::Decimate(signal, factor));
  }
  if (const auto speed_rad_per_s = SteadyInputSpeedOf_rad_per_s(record)) {
    signals.samples_per_turn = rate_hz / factor * kTwoPi / *speed_rad_per_s;
  }
  return signals;
}

void RequireAlive(const daq::Record& record, const RecordSignals& signals,
                  const std::vector<std::string>& channels) {
  for (std::size_t k = 0; k < channels.size(); ++k) {
    if (const auto fault = SensorFault(channels[k], signals.channels[k]))
      throw RecordRefusal(record, fault->text);
  }
}

std::vector<double> FeaturesOfWindow(const daq::Record& record, const RecordSignals& signals,
                                     const Window& window, ChannelFeatures& features) {
  const std::size_t per_channel = features.CountPerChannel();
  std::vector<double> values(signals.channels.size() * per_channel);
  try {
    for (std::size_t k = 0; k < signals.channels.size(); ++k) {
      features.Compute(std::span(signals.channels[k]).subspan(window.begin, window.count),
                       signals.samples_per_turn, std::span(values).subspan(k * per_channel, per_channel));
    }
  } catch (const std::invalid_argument& error) {
    throw RecordRefusal(record, error.what());
  }
  return values;
}

}  // namespace strainwave::bench
