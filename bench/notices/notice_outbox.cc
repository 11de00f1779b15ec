// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_outbox.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace strainwave::bench {
namespace {

constexpr double kFirstPause_s = 10.0;
constexpr double kLongestPause_s = 600.0;
constexpr double kGivenUpAfter_s = 24.0 * 3600.0;

bool WaitsFor(const WaitingNotice& waiting, std::string_view channel) {
  return std::ranges::find(waiting.channels, channel) != waiting.channels.end();
}

ChannelState* ChannelNamed(NoticeOutbox& outbox, std::string_view name) {
  const auto found = std::ranges::find(outbox.channels, name, &ChannelState::name);
  return found == outbox.channels.end() ? nullptr : &*found;
}

void DropDone(NoticeOutbox& outbox) {
  std::erase_if(outbox.waiting, [](const WaitingNotice& waiting) { return waiting.channels.empty(); });
}

}  // namespace

double PauseAfter_s(int failures) {
  return failures < 1 ? 0.0 : std::min(kFirstPause_s * std::exp2(failures - 1), kLongestPause_s);
}

void UseChannels(NoticeOutbox& outbox, const std::vector<std::string>& names) {
  std::vector<ChannelState> used;
  for (const std::string& name : names) {
    const ChannelState* const known = ChannelNamed(outbox, name);
    used.push_back(known == nullptr ? ChannelState{name, 0, {}, {}} : *known);
  }
  outbox.channels = std::move(used);
  for (WaitingNotice& waiting : outbox.waiting) {
    std::erase_if(waiting.channels, [&](const std::string& channel) {
      return std::ranges::find(names, channel) == names.end();
    });
  }
  DropDone(outbox);
}

void Put(NoticeOutbox& outbox, std::vector<Notice> notices, const Moment& now) {
  std::vector<std::string> names;
  for (const ChannelState& channel : outbox.channels) names.push_back(channel.name);
  for (Notice& notice : notices) outbox.waiting.push_back({std::move(notice), now, names, 0});
  DropDone(outbox);
}

const Notice* NextFor(const NoticeOutbox& outbox, std::string_view channel, const Moment& now) {
  const auto state = std::ranges::find(outbox.channels, channel, &ChannelState::name);
  if (state == outbox.channels.end()) return nullptr;
  if (state->failed) {
    // A pause that no clock can tell is over.
    const auto ago_s = PauseBetween(*state->failed, now).length_s;
    if (ago_s && *ago_s < PauseAfter_s(state->failures)) return nullptr;
  }
  const WaitingNotice* next = nullptr;
  const auto rank = [](const WaitingNotice& waiting) {
    return std::tuple(waiting.tries, -static_cast<int>(waiting.notice.priority));
  };
  for (const WaitingNotice& waiting : outbox.waiting) {
    if (WaitsFor(waiting, channel) && (next == nullptr || rank(waiting) < rank(*next))) next = &waiting;
  }
  return next == nullptr ? nullptr : &next->notice;
}

void Delivered(NoticeOutbox& outbox, std::string_view channel, std::string_view id) {
  for (WaitingNotice& waiting : outbox.waiting) {
    if (waiting.notice.id == id) std::erase(waiting.channels, channel);
  }
  DropDone(outbox);
  if (ChannelState* const state = ChannelNamed(outbox, channel)) {
    state->failures = 0;
    state->failed.reset();
    state->trouble.clear();
  }
}

bool Failed(NoticeOutbox& outbox, std::string_view channel, std::string_view id, const std::string& cause,
            const Moment& now) {
  for (WaitingNotice& waiting : outbox.waiting) {
    if (waiting.notice.id == id) ++waiting.tries;
  }
  ChannelState* const state = ChannelNamed(outbox, channel);
  if (state == nullptr) return false;
  ++state->failures;
  state->failed = now;
  return std::exchange(state->trouble, cause) != cause;
}

std::vector<std::string> GiveUpOld(NoticeOutbox& outbox, const Moment& now) {
  std::vector<std::string> lines;
  std::erase_if(outbox.waiting, [&](const WaitingNotice& waiting) {
    const auto waited_s = PauseBetween(waiting.planned, now).length_s;
    if (!waited_s || *waited_s < kGivenUpAfter_s) return false;
    lines.push_back(fmt::format("given up after a day on {}: {}", fmt::join(waiting.channels, ", "),
                                waiting.notice.subject));
    return true;
  });
  return lines;
}

}  // namespace strainwave::bench
