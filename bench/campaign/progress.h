// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// How far a running campaign is.
struct ProgressState {
  int cycle{};   // 0: preparation
  int cycles{};  // of the schedule
  std::string_view phase;
  double share{};                                  // done of the whole campaign, by planned bench time
  std::span<const ChannelTrouble> bad_channels{};  // while they are, valid during the call
};

/// Where a campaign tells people what it does: a terminal, a log, nobody.
class ProgressSink {
 public:
  ProgressSink() = default;
  ProgressSink(const ProgressSink&) = delete;
  ProgressSink& operator=(const ProgressSink&) = delete;
  virtual ~ProgressSink() = default;

  /// Often; the sink thins it out itself.
  virtual void Update(const ProgressState& state) = 0;
  virtual void Message(std::string_view severity, std::string_view text) = 0;
  virtual void CycleStored(int cycle, const std::vector<Result>& results) = 0;
};

}  // namespace strainwave::bench
