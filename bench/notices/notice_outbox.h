// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/notices/notice.h"
#include "bench/notices/notice_plan.h"

namespace strainwave::bench {

/// A notice, and the channels that have not taken it yet.
struct WaitingNotice {
  Notice notice;
  Moment planned;
  std::vector<std::string> channels;
  int tries{};  // that have failed, on all channels together
};

struct ChannelState {
  std::string name;  // mail, webhook, mqtt
  int failures{};    // since it last took something
  std::optional<Moment> failed;
  std::string trouble;  // why; empty while it works
};

/// What waits to be sent, and how the channels do.
struct NoticeOutbox {
  std::vector<WaitingNotice> waiting;  // oldest first
  std::vector<ChannelState> channels;
};

/// All that a watch keeps beside a campaign.
struct NoticeState {
  NoticeMemory memory;
  NoticeOutbox outbox;
};

/// How long a channel is left alone after so many failures in a row: 10 s, twice as long each time, at most
/// 10 min.
double PauseAfter_s(int failures);

/// Has exactly these channels from now on: what waits for another one alone is let go.
void UseChannels(NoticeOutbox& outbox, const std::vector<std::string>& names);

/// For all channels.
void Put(NoticeOutbox& outbox, std::vector<Notice> notices, const Moment& now);

/// What a channel is to send now: of those with the fewest failed tries the most urgent, then the oldest, so
/// that one which is refused holds up no other. Null while nothing waits for it or it is to be left alone.
const Notice* NextFor(const NoticeOutbox& outbox, std::string_view channel, const Moment& now);

void Delivered(NoticeOutbox& outbox, std::string_view channel, std::string_view id);
/// @return whether that is news: another trouble than the one before.
bool Failed(NoticeOutbox& outbox, std::string_view channel, std::string_view id, const std::string& cause,
            const Moment& now);

/// What has waited for a day is let go. @return a line for each.
std::vector<std::string> GiveUpOld(NoticeOutbox& outbox, const Moment& now);

}  // namespace strainwave::bench
