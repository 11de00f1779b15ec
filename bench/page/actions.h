// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "bench/campaign/end_request.h"
#include "bench/page/page_state.h"
#include "bench/page/tokens.h"

namespace strainwave::bench {

/// A status of HTTP and what goes with it.
struct ActionAnswer {
  int status{};
  nlohmann::json body;
};

/// Asks the process that runs the campaign; returns its id, 0 where there is none.
using AskProcess = std::function<int(EndRequest)>;

/// Carries out `POST /api/v1/actions`: {"action", "run", "token"}. Nothing is done for a run that is not the
/// one of the snapshot, nor twice with one token; the answer then says so, and brings what a page needs to
/// ask again (`run`, `token`).
/// @param now_utc  for the answer to a second use of the token.
ActionAnswer Act(std::string_view request, const CampaignSnapshot& snapshot, Tokens& tokens,
                 const AskProcess& ask, const std::string& now_utc);

}  // namespace strainwave::bench
