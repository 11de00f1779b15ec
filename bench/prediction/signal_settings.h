// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace strainwave::bench {

/// One channel under the name of its column, in the unit that the name ends in.
struct NamedSignal {
  std::string_view name;
  std::span<const double> samples;
};

/// How long a window of a record is: so many turns of the input shaft where `turns` is not 0, each record's
/// own number of samples; else so many samples; with both 0 the record is one window.
struct WindowLength {
  std::size_t samples{};
  int turns{};

  bool operator==(const WindowLength&) const = default;
};

/// Which channels of a record are taken, and at what rate.
struct SignalSettings {
  std::vector<std::string> channels;  // in this order
  double sample_rate_hz{};
  bool decimates{};  // a whole multiple of the rate is brought down to it
};

/// Why signals cannot be predicted from. The numbers go to PLCs and never change their meaning.
enum class SignalFaultKind {
  kSampleRate = 1,
  kMissingChannel = 2,
  kTooShort = 3,
  kNotFinite = 4,  // or beyond what the quantity can be
  kDead = 5,
  kClipped = 6,
  kSwapped = 7,
  kUndefined = 8,   // a feature or a prediction is no number
  kGap = 9,         // the stream broke off within the window
  kUnreadable = 10  // the source could not deliver it
};

/// "sample_rate", "missing_channel", …
std::string_view NameOf(SignalFaultKind kind);

struct SignalFault {
  SignalFaultKind kind{};
  std::string text;  // "WHAT (what was expected)"
};

/// By how much signals at this rate are to be brought down; 0 where the rate is another one (by more than a
/// hundredth).
int DecimationFactor(double rate_hz, const SignalSettings& settings);
SignalFault RateFault(double rate_hz, const SignalSettings& settings);
SignalFault MissingChannel(const std::string& channel, const SignalSettings& settings);

/// What is wrong with the sensor behind a signal: a value that is no number or out of the bounds of its unit
/// (`daq/value_bounds.h`), one value throughout (not connected), or so many samples at its highest or lowest
/// value that it is at its end.
std::optional<SignalFault> SensorFault(const std::string& channel, std::span<const double> signal);

}  // namespace strainwave::bench
