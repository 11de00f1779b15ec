// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bench/campaign/pause.h"

namespace strainwave::bench {

/// Property of a campaign's journal: when its last run began (`TextOf`).
inline constexpr const char* kRunBegun = "run_begun";

/// Property: at how many times real time a simulated bench ran last, as `run --pace` has it.
inline constexpr const char* kRunPace = "run_pace";

struct RunBegun {
  std::int64_t utc_ms{};
  double time_s{};  // of the bench
  int process{};    // 0: an earlier version did not say which
  std::int64_t since_boot_ms{};
  std::uint64_t boot{};  // 0: an earlier version did not say which

  Moment moment() const { return {utc_ms, since_boot_ms, boot}; }
};

/// "MILLISECONDS_UTC BENCH_SECONDS PROCESS MILLISECONDS_SINCE_BOOT BOOT".
std::string TextOf(const RunBegun& begun);
/// Nothing where the text is none of these.
std::optional<RunBegun> ParseRunBegun(const std::string& text);

}  // namespace strainwave::bench
