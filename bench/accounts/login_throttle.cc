// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/login_throttle.h"

#include <algorithm>

namespace strainwave::bench {
namespace {

std::chrono::seconds WaitAfter(int wrong) {
  constexpr int kMostDoublings = 6;  // 64 s
  return std::min(LoginThrottle::kLongestWait,
                  std::chrono::seconds(1 << std::min(wrong - 1, kMostDoublings)));
}

}  // namespace

std::chrono::milliseconds LoginThrottle::Wait(std::string_view name, Time now) const {
  const auto found = tries_.find(name);
  if (found == tries_.end()) return {};
  const auto left = found->second.last + WaitAfter(found->second.wrong) - now;
  return std::max(std::chrono::milliseconds(0), std::chrono::ceil<std::chrono::milliseconds>(left));
}

void LoginThrottle::Failed(std::string_view name, Time now) {
  std::erase_if(tries_, [&](const auto& entry) { return now - entry.second.last >= kForgottenAfter; });
  const auto known = tries_.find(name);
  if (known == tries_.end() && tries_.size() >= kMostNames) {
    tries_.erase(std::ranges::min_element(tries_, {}, [](const auto& entry) { return entry.second.last; }));
  }
  Tries& tries = tries_[std::string(name)];
  ++tries.wrong;
  tries.last = now;
}

void LoginThrottle::Succeeded(std::string_view name) {
  const auto found = tries_.find(name);
  if (found != tries_.end()) tries_.erase(found);
}

}  // namespace strainwave::bench
