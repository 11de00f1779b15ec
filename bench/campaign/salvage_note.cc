// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/salvage_note.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/json_property.h"

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
  journal.SetProperty(kSalvage, Json(note).dump());
}

std::optional<SalvageNote> SalvageNoteOf(const Journal& journal) {
  std::optional<SalvageNote> note;
  ReadJsonProperty(journal, kSalvage, [&](const nlohmann::json& kept) { note = kept.get<SalvageNote>(); });
  return note;
}

nlohmann::json Json(const SalvageNote& note) { return note; }

std::string Words(const SalvageNote& note) {
  return fmt::format("salvaged from {} at {}: {} file(s), {} record(s) and {} row(s) are lost", note.from,
                     note.utc, note.files_lost.size(), note.records_lost.size(), RowsLost(note));
}

}  // namespace strainwave::bench
