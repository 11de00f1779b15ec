// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/central/campaign_query.h"
#include "bench/central/record_store.h"
#include "bench/central/server.h"

namespace strainwave::bench {

struct FetchedCampaign {
  std::filesystem::path folder;
  int cycles{};   // complete
  int records{};  // files that the store had
  std::vector<std::string> warnings;
};

/// Writes a campaign's folder anew from what the server has of it: the frozen inputs, and a journal of the
/// same rows with the same chain, so that every command that reads a campaign takes it. Raw records come from
/// a store, where one is given and has them. The folder appears whole or not at all.
/// @param into  where the campaign's folder is to lie, under `FoundCampaign::Name`.
/// @throws BenchError (exit code 2) where there is such a folder already, or the server has no inputs for it;
///   ServerError, DatabaseError, std::system_error.
FetchedCampaign FetchCampaign(Server& server, const FoundCampaign& campaign,
                              const std::filesystem::path& into, const RecordStore* store);

}  // namespace strainwave::bench
