// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/login_throttle.h"

#include <algorithm>

#include <fmt/format.h>

namespace strainwave::bench {
namespace {

using std::chrono::milliseconds;

std::chrono::seconds WaitAfter(int wrong) {
  constexpr int kMostDoublings = 6;  // 64 s
  return std::min(LoginThrottle::kLongestWait,
                  std::chrono::seconds(1 << std::min(wrong - 1, kMostDoublings)));
}

// No name and no address holds a line feed.
std::string PairOf(std::string_view name, std::string_view address) {
  return fmt::format("{}\n{}", name, address);
}

}  // namespace

milliseconds LoginThrottle::WaitOf(const Counts& counts, std::string_view who, int free, Time now) {
  const auto found = counts.find(who);
  if (found == counts.end() || found->second.wrong <= free) return {};
  const auto left = found->second.last + WaitAfter(found->second.wrong - free) - now;
  return std::max(milliseconds(0), std::chrono::ceil<milliseconds>(left));
}

milliseconds LoginThrottle::Wait(std::string_view name, std::string_view address, Time now) const {
  const std::string pair = PairOf(name, address);
  const milliseconds own = WaitOf(pairs_, pair, 0, now);
  const auto known = known_.find(pair);
  if (known != known_.end() && now - known->second < kKnownFor) return own;
  return std::max({own, WaitOf(addresses_, address, kFree, now), WaitOf(names_, name, kFree, now)});
}

void LoginThrottle::Count(Counts& counts, std::string who, Time now) {
  std::erase_if(counts, [&](const auto& entry) { return now - entry.second.last >= kForgottenAfter; });
  if (!counts.contains(who) && counts.size() >= kMostKept) {
    counts.erase(std::ranges::min_element(counts, {}, [](const auto& entry) { return entry.second.last; }));
  }
  Tries& tries = counts[std::move(who)];
  ++tries.wrong;
  tries.last = now;
}

void LoginThrottle::TakeBack(Counts& counts, std::string_view who) {
  const auto found = counts.find(who);
  if (found != counts.end() && --found->second.wrong <= 0) counts.erase(found);
}

void LoginThrottle::Failed(std::string_view name, std::string_view address, Time now) {
  Count(pairs_, PairOf(name, address), now);
  Count(addresses_, std::string(address), now);
  Count(names_, std::string(name), now);
}

void LoginThrottle::Succeeded(std::string_view name, std::string_view address, Time now) {
  const std::string pair = PairOf(name, address);
  pairs_.erase(pair);
  TakeBack(addresses_, address);
  TakeBack(names_, name);
  if (!known_.contains(pair) && known_.size() >= kMostKept) {
    known_.erase(std::ranges::min_element(known_, {}, [](const auto& entry) { return entry.second; }));
  }
  known_[pair] = now;
}

}  // namespace strainwave::bench
