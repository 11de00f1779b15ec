// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// What a campaign that `strainwave verify --salvage` has written says of the one that it was taken from:
/// such a campaign is for analysis, and is not gone on with. Kept as a property of the journal.
struct SalvageNote {
  std::string from;  // folder
  std::string utc;
  std::string chain_head;  // of that one's journal, as far as it could be read
  std::int64_t files_recovered{};
  std::vector<std::string> files_lost;                 // paths from the campaign's folder on
  std::int64_t records_recovered{};                    // of files that are damaged
  std::vector<std::string> records_lost;               // "cycles/000002.h5 /hysteresis/hysteresis_1"
  std::map<std::string, std::int64_t> rows_recovered;  // by table
  std::map<std::string, std::int64_t> rows_lost;
  std::vector<int> cycles_incomplete;  // complete ones of whose rows some are lost
};

void KeepSalvageNote(Journal& journal, const SalvageNote& note);
/// Nothing for a campaign that was measured.
std::optional<SalvageNote> SalvageNoteOf(const Journal& journal);

/// "salvaged from DIR at UTC: 2 file(s), 1 record(s) and 0 row(s) are lost".
std::string Words(const SalvageNote& note);
nlohmann::json Json(const SalvageNote& note);

}  // namespace strainwave::bench
