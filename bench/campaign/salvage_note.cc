// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/salvage_note.h"

#include <fmt/core.h>
#include <sqlite3.h>
#include <nlohmann/json.hpp>

namespace strainwave::bench {
namespace {

constexpr const char* kSalvage = "salvage";

std::int64_t RowsLost(const SalvageNote& note) {
  std::int64_t lost = 0;
  for (const auto& [table, count] : note.rows_lost) lost += count;
  return lost;
}

}  // namespace

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SalvageNote, from, utc, chain_head, files_recovered, files_lost,
                                   records_recovered, records_lost, rows_recovered, rows_lost,
                                   cycles_incomplete)

void KeepSalvageNote(Journal& journal, const SalvageNote& note) {
  journal.SetProperty(kSalvage, nlohmann::json(note).dump());
}

std::optional<SalvageNote> SalvageNoteOf(const Journal& journal) {
  const auto text = journal.Property(kSalvage);
  if (!text) return std::nullopt;
  // A property of the journal may be anything in a folder from elsewhere.
  try {
    return nlohmann::json::parse(*text).get<SalvageNote>();
  } catch (const nlohmann::json::exception&) {
    throw DatabaseError(
        journal.database().file(), SQLITE_CORRUPT,
        fmt::format("the property '{}' cannot be read (expected it as the program has kept it)", kSalvage));
  }
}

std::string Words(const SalvageNote& note) {
  return fmt::format("salvaged from {} at {}: {} file(s), {} record(s) and {} row(s) are lost", note.from,
                     note.utc, note.files_lost.size(), note.records_lost.size(), RowsLost(note));
}

std::string JsonText(const SalvageNote& note) { return nlohmann::json(note).dump(); }

}  // namespace strainwave::bench
