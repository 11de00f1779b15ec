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
  int missing{};  // files of the journal that it has not, or damaged; none without a store
  std::vector<std::string> warnings;
};

/// Whether folders of these campaigns can be made there. @throws BenchError (exit code 2) where one is there
/// already, or the place is a file, or lies in a campaign's own folder.
void DemandFetchPlace(const std::filesystem::path& into, const std::vector<FoundCampaign>& campaigns);

/// Writes a campaign's folder anew from what the server has of it: the frozen inputs, and a journal of the
/// same rows with the same chain, so that every command that reads a campaign takes it. Raw records come from
/// a store, where one is given and has them. The folder appears whole or not at all.
/// @param into  where the campaign's folder is to lie, under `FoundCampaign::Name`.
/// @throws BenchError (exit code 2) where there is such a folder already, another program is at work on it,
/// or
///   the server has no inputs for it; ServerError, DatabaseError, std::system_error.
FetchedCampaign FetchCampaign(Server& server, const FoundCampaign& campaign,
                              const std::filesystem::path& into, const RecordStore* store);

}  // namespace strainwave::bench
