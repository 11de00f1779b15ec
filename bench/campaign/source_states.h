// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/campaign/journal.h"
#include "bench/campaign/live_sources.h"
#include "bench/configuration/bench_description.h"

namespace strainwave::bench {

enum class SourceCondition {
  kNotRunning,  // nobody runs the campaign: nothing is known of now
  kGood,
  kLosing,   // samples were lost within the last minute
  kSilent,   // nothing comes
  kTrouble,  // the device says what is wrong, or a channel of it gives no value
};

/// "not running", "good", "losing samples", "silent", "trouble".
std::string_view NameOf(SourceCondition condition);

/// A device that readings come from, or the simulated bench as one.
struct SourceState {
  std::string source;
  SourceCondition condition{};
  std::string words{};                   // what is wrong, or was lost and when; empty: nothing
  std::vector<std::string> channels{};   // of the bench, that come from it
  std::optional<SourceCounts> counts{};  // of a stream of samples, once one has come
};

/// A stream that gave nothing for so long is silent, and one that has lost samples within so long is losing.
inline constexpr std::int64_t kSilentAfter_ms = 5'000;
inline constexpr std::int64_t kLosingFor_ms = 60'000;

/// A run that has said nothing of its streams for so long is held up; what they do is not known.
inline constexpr double kOldestCounts_s = 10.0;

/// Of all of the bench, in the order of its file.
/// @param bad   channels without a value, as the journal has them
/// @param live  what came of its streams; nothing: not known
std::vector<SourceState> SourceStates(const BenchDescription& bench, const std::vector<ChannelTrouble>& bad,
                                      const std::optional<LiveSources>& live, bool is_running,
                                      const Moment& now);

}  // namespace strainwave::bench
