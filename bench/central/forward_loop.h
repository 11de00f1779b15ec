// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/central/campaign_forward.h"

namespace strainwave::bench {

struct ForwardOrder {
  std::vector<std::string> folders;
  std::string conninfo;
  ForwardSettings settings;
  bool follow{};        // goes on until it is asked to end
  double patience_s{};  // without follow: how long a server may be away, attempts included
  double first_wait_s{1.0};
  double round_s{15.0};   // between two looks at the campaigns
  ServerPatience server;  // within one attempt
};

/// How long to wait before the next attempt: from 1 s on twice as long each time, a minute at most, and by
/// chance down to a half of that, so that the benches of a lab do not all come back in the same moment.
/// @param attempt  from 1 on; @param chance  from 0 to 1.
double WaitsBeforeAttempt(int attempt, double chance);

/// Forwards campaigns, over a connection that is there while there is something to say, until the server has
/// all of them, or for ever. A server that is away is waited for; a campaign that cannot be read holds up no
/// other.
/// @param is_to_end  asked several times a second.
/// @param tell  takes a sentence for people.
/// @return whether everything was brought; with `follow` it returns when it is asked to end.
/// @throws ServerError where the server refuses, or is away for longer than the order's patience; without
///   `follow` as OpenCampaign, and BenchError (exit code 130) where it is asked to end before all is brought.
bool RunForward(const ForwardOrder& order, const std::function<bool()>& is_to_end,
                const std::function<void(const std::string&)>& tell);

}  // namespace strainwave::bench
