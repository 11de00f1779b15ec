// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "bench/campaign/pause.h"

namespace strainwave::bench {

/// Of the notices that are due, how many go by themselves; whether the rest goes as one summary, or waits.
struct NoticeRoom {
  std::size_t by_themselves{};  // of the most urgent
  bool summary{};               // of all others, in one notice
};

/// @param urgent    due, of high priority; they stand first
/// @param others    due, of lower ones
/// @param sent      within the last hour
/// @param per_hour  at least 2. A quarter of it, at least one, is kept for what is urgent.
NoticeRoom RoomFor(std::size_t urgent, std::size_t others, std::size_t sent, int per_hour);

/// Leaves those of the last hour. A time that no clock can tell is longer ago.
void ForgetSent(std::vector<Moment>& sent, const Moment& now);

}  // namespace strainwave::bench
