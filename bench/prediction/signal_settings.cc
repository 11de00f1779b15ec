// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/signal_settings.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "daq/value_bounds.h"

namespace strainwave::bench {
namespace {

constexpr double kRateTolerance = 0.01;
constexpr double kMostDecimation = 1e6;  // from the fastest converters down to a sample in a millisecond
// So many equal samples in a row at the very top or bottom are a sensor at its end.
constexpr int kClippedRun = 6;
constexpr const char* kMotorVelocity = "velocity_rad_per_s";

int LongestRunAt(std::span<const double> signal, double value) {
  int longest = 0;
  int run = 0;
  for (const double sample : signal) {
    run = sample == value ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

}  // namespace

std::string_view NameOf(SignalFaultKind kind) {
  switch (kind) {
    case SignalFaultKind::kSampleRate:
      return "sample_rate";
    case SignalFaultKind::kMissingChannel:
      return "missing_channel";
    case SignalFaultKind::kTooShort:
      return "too_short";
    case SignalFaultKind::kNotFinite:
      return "not_finite";
    case SignalFaultKind::kDead:
      return "dead";
    case SignalFaultKind::kClipped:
      return "clipped";
    case SignalFaultKind::kSwapped:
      return "swapped";
    case SignalFaultKind::kUndefined:
      return "undefined";
    case SignalFaultKind::kGap:
      return "gap";
    case SignalFaultKind::kUnreadable:
      return "unreadable";
  }
  return "unreadable";
}

int DecimationFactor(double rate_hz, const SignalSettings& settings) {
  const double ratio = rate_hz / settings.sample_rate_hz;
  const double factor = settings.decimates ? std::max(1.0, std::round(ratio)) : 1.0;
  const bool fits = factor <= kMostDecimation && std::abs(ratio / factor - 1.0) <= kRateTolerance;
  return fits ? static_cast<int>(factor) : 0;
}

SignalFault RateFault(double rate_hz, const SignalSettings& settings) {
  return {SignalFaultKind::kSampleRate,
          fmt::format("the sampling rate is {:g} Hz (expected {:g} Hz{}, as in training)", rate_hz,
                      settings.sample_rate_hz, settings.decimates ? " or a multiple of it" : "")};
}

SignalFault MissingChannel(const std::string& channel, const SignalSettings& settings) {
  return {SignalFaultKind::kMissingChannel,
          fmt::format("there is no channel {} (expected {})", channel, fmt::join(settings.channels, ", "))};
}

std::optional<SignalFault> SensorFault(const std::string& channel, std::span<const double> signal) {
  const daq::ValueBounds& bounds = daq::BoundsOf(channel);
  if (const auto odd = daq::FindImplausible(signal, bounds)) {
    const double value = signal[*odd];
    return SignalFault{SignalFaultKind::kNotFinite,
                       fmt::format("{} is {} at sample {} (expected {})", channel, value, *odd + 1,
                                   std::isfinite(value) ? bounds.Text() : "a number")};
  }
  const auto [low, high] = std::ranges::minmax(signal);
  if (low == high) {
    return SignalFault{
        SignalFaultKind::kDead,
        fmt::format("{} is {} throughout (expected a signal: is the sensor connected?)", channel, low)};
  }
  for (const double end : {low, high}) {
    if (end == 0.0 && channel == kMotorVelocity) continue;  // of a shaft that turns one way, at rest
    const int run = LongestRunAt(signal, end);
    if (run >= kClippedRun) {
      return SignalFault{
          SignalFaultKind::kClipped,
          fmt::format("{} stays at its end value {} for {} samples (expected a sensor within its range)",
                      channel, end, run)};
    }
  }
  return std::nullopt;
}

}  // namespace strainwave::bench
