// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/central/server.h"

namespace strainwave::bench {

/// Campaigns are asked for by "bench=hall-* specimen=A1,A2 schedule=paper": all conditions hold, any of the
/// values of one; '*' stands for anything, '?' for one character. Empty: all campaigns.
struct CampaignQuery {
  std::string condition;  // of SQL, over benches b and campaigns c, with $1, $2 and so on
  std::vector<ServerValue> values;
};

/// @throws BenchError (exit code 2) with the word that cannot be read.
CampaignQuery ParseCampaignQuery(const std::string& text);

struct FoundCampaign {
  std::string campaign_id;
  std::string bench_id;
  std::string month;
  std::string bench;
  std::string specimen;
  std::string schedule;
  std::string identity;
  std::string started_utc;
  int complete{};    // cycles, at the server
  bool caught_up{};  // nothing was left when it was last forwarded
  /// Of a copy of a campaign that was found, too, and counts: its name. Empty: it counts itself.
  std::string same_as{};

  /// "hall-3-0f12ab34": of a folder.
  std::string Name() const { return bench + '-' + identity.substr(0, 8); }
};

/// By bench, then by when they were begun; at most so many. Where several benches have forwarded copies of
/// one campaign's folder, the one with the most cycles counts; of equals, that which came first.
/// @throws ServerError.
std::vector<FoundCampaign> FindCampaigns(Server& server, const CampaignQuery& query, int most = 1000);

}  // namespace strainwave::bench
