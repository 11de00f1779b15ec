// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/record_windows.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/features/decimation.h"
#include "bench/diagnosis/record_checks.h"
#include "bench/prediction/record_features.h"

namespace strainwave::bench {
namespace {

constexpr double kRateTolerance = 0.01;
// So many equal samples in a row at the very top or bottom are a sensor at its end.
constexpr int kClippedRun = 6;

int LongestRunAt(std::span<const double> signal, double value) {
  int longest = 0;
  int run = 0;
  for (const double sample : signal) {
    run = sample == value ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

// By how much the record is to be brought down.
int FactorOf(const daq::Record& record, double rate_hz, const SignalSettings& settings) {
  const double ratio = rate_hz / settings.sample_rate_hz;
  const double factor = settings.decimates ? std::max(1.0, std::round(ratio)) : 1.0;
  if (!(std::abs(ratio / factor - 1.0) <= kRateTolerance)) {
    throw RecordRefusal(
        record, fmt::format("the sampling rate is {:g} Hz (expected {:g} Hz{}, as in training)", rate_hz,
                            settings.sample_rate_hz, settings.decimates ? " or a multiple of it" : ""));
  }
  return static_cast<int>(factor);
}

}  // namespace

std::vector<Window> WindowsOf(std::size_t rows, std::optional<double> samples_per_turn,
                              const WindowLength& length) {
  if (length.turns == 0 && length.samples == 0) return {{0, rows}};
  if (length.turns > 0 && !samples_per_turn) {
    throw std::invalid_argument("samples_per_turn is not known (expected it for windows of whole turns)");
  }
  const double step =
      length.turns > 0 ? *samples_per_turn * length.turns : static_cast<double>(length.samples);
  const auto count = static_cast<std::size_t>(step);
  std::vector<Window> windows;
  for (std::size_t k = 0;; ++k) {
    const auto begin = static_cast<std::size_t>(std::lround(static_cast<double>(k) * step));
    if (count == 0 || begin + count > rows) return windows;
    windows.push_back({begin, count});
  }
}

RecordSignals SignalsOf(const daq::Record& record, const SignalSettings& settings) {
  const int factor = FactorOf(record, SampleRateOf_hz(record), settings);
  RecordSignals signals;
  for (const std::string& channel : settings.channels) {
    if (record.FindColumn(channel) == nullptr) {
      throw RecordRefusal(record, fmt::format("there is no channel {} (expected {})", channel,
                                              fmt::join(settings.channels, ", ")));
    }
    std::vector<double> signal = record.CopyAsDoubles(channel);
    signals.channels.push_back(factor == 1 ? std::move(signal)
                                           : analysis::features::Decimate(signal, factor));
  }
  if (const auto speed_rad_per_s = SteadyInputSpeedOf_rad_per_s(record)) {
    signals.samples_per_turn = SampleRateOf_hz(record) / factor * 2.0 * std::numbers::pi / *speed_rad_per_s;
  }
  return signals;
}

void RequireAlive(const daq::Record& record, const RecordSignals& signals,
                  const std::vector<std::string>& channels) {
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const auto [low, high] = std::ranges::minmax(signals.channels[k]);
    if (low == high) {
      throw RecordRefusal(
          record,
          fmt::format("{} is {} throughout (expected a signal: is the sensor connected?)", channels[k], low));
    }
    for (const double end : {low, high}) {
      const int run = LongestRunAt(signals.channels[k], end);
      if (run >= kClippedRun) {
        throw RecordRefusal(
            record,
            fmt::format("{} stays at its end value {} for {} samples (expected a sensor within its range)",
                        channels[k], end, run));
      }
    }
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
