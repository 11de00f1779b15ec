// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_rate.h"

#include <algorithm>

namespace strainwave::bench {
namespace {

constexpr double kHour_s = 3600.0;

}  // namespace

NoticeRoom RoomFor(std::size_t urgent, std::size_t others, std::size_t sent, int per_hour) {
  const auto most = static_cast<std::size_t>(std::max(per_hour, 2));
  const std::size_t free = most - std::min(most, sent);
  if (urgent > free) return free == 0 ? NoticeRoom{} : NoticeRoom{free - 1, true};
  const std::size_t most_others = most - std::max<std::size_t>(1, most / 4);
  const std::size_t taken = sent + urgent;
  const std::size_t free_for_others = most_others - std::min(most_others, taken);
  if (others <= free_for_others) return {urgent + others, false};
  return free_for_others == 0 ? NoticeRoom{urgent, false} : NoticeRoom{urgent + free_for_others - 1, true};
}

void ForgetSent(std::vector<Moment>& sent, const Moment& now) {
  std::erase_if(sent, [&](const Moment& moment) {
    const auto ago_s = PauseBetween(moment, now).length_s;
    return !ago_s || *ago_s >= kHour_s;
  });
}

}  // namespace strainwave::bench
