// SPDX-License-Identifier: Apache-2.0
#include "bench/page/viewers.h"

#include <utility>

#include <fmt/core.h>

#include "bench/page/actions.h"
#include "bench/page/event_stream.h"
#include "bench/page/http_text.h"

namespace strainwave::bench {

void Viewers::Add(ClientId client, std::int64_t last_event, std::string session) {
  streams_[client] = {last_event, std::move(session)};
}

std::vector<Viewers::Delivery> Viewers::EndWhere(
    const std::function<bool(const std::string& session)>& is_over) {
  std::vector<Delivery> ended;
  std::erase_if(streams_, [&](const auto& entry) {
    if (!is_over(entry.second.session)) return false;
    ended.push_back({entry.first, EventFrame("over", JsonText(MustLogIn())), true});
    return true;
  });
  return ended;
}

std::vector<Viewers::Delivery> Viewers::Alive(std::int64_t now_utc_ms) const {
  const std::string alive = EventFrame("alive", fmt::format("{{\"now_ms\":{}}}", now_utc_ms));
  std::vector<Delivery> deliveries;
  for (const auto& [client, stream] : streams_) deliveries.push_back({client, alive});
  return deliveries;
}

std::vector<Viewers::Delivery> Viewers::News(const WatchedCampaign& newest, const Moment& now) {
  const std::string state = EventFrame("state", JsonText(StateJson(newest.snapshot, now)));
  std::vector<Delivery> deliveries;
  for (auto& [client, stream] : streams_) {
    deliveries.push_back({client, JournalFrames(newest.events, stream.last_event) + state});
    stream.last_event = newest.snapshot.last_event;
  }
  return deliveries;
}

}  // namespace strainwave::bench
