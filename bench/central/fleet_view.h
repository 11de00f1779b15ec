// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "bench/central/campaign_query.h"
#include "bench/central/server.h"

namespace strainwave::bench {

/// Which benches a page of the list shows.
struct BenchesAsked {
  std::string find;   // in the names of bench, specimen and schedule; empty: all
  std::string state;  // empty: all
  int from{};         // rows before are left out
  int most{200};
};

/// Benches with what each does, those that want a look first; how many there are in each state, and of
/// `asked` in all. A bench of which a campaign runs and nothing has come for 15 minutes is "silent".
nlohmann::json BenchesJson(Server& server, const BenchesAsked& asked);

/// Specimens beside each other by one quantity: its value in the first complete cycle that has it and in the
/// last, of at most 200 campaigns.
nlohmann::json ComparisonJson(Server& server, const std::string& quantity, const CampaignQuery& query);

/// Names of all quantities that there are results of.
nlohmann::json QuantitiesJson(Server& server);

}  // namespace strainwave::bench
