// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "bench/page/campaign_watch.h"
#include "bench/serving/tcp_server.h"

namespace strainwave::bench {

/// Who looks on: the open streams of events, and what each of them has still to be told.
class Viewers {
 public:
  using ClientId = RequestProtocol::ClientId;
  using Delivery = RequestProtocol::Delivery;

  /// @param last_event  the line of the journal that the viewer has or is about to get; @param session  of
  /// who looks on, empty for nobody who is logged in.
  void Add(ClientId client, std::int64_t last_event, std::string session);
  void Remove(ClientId client) { streams_.erase(client); }
  std::size_t count() const { return streams_.size(); }

  /// Last words to those whose session does not hold any more; they are closed, and no viewers from now on.
  std::vector<Delivery> EndWhere(const std::function<bool(const std::string& session)>& is_over);
  /// To each: nothing has changed, and the page's program is there.
  std::vector<Delivery> Alive(std::int64_t now_utc_ms) const;
  /// To each the state, after the lines of the journal that it does not have.
  std::vector<Delivery> News(const WatchedCampaign& newest, const Moment& now);

 private:
  struct Stream {
    std::int64_t last_event{};
    std::string session;
  };

  std::map<ClientId, Stream> streams_;
};

}  // namespace strainwave::bench
