// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "bench/campaign/journal.h"
#include "bench/campaign/salvage_note.h"

namespace strainwave::bench {

/// Copies every row that can be read from a journal of which pages may be damaged. A damaged page costs the
/// rows on it; those after it are found by their keys.
/// @param into  a new journal, empty.
/// @param least  rows that there were at least, by table, as chain and checkpoint tell.
/// @param note   gets rows_recovered, and rows_lost of the tables whose rows are numbered without gaps.
void CopyRows(const Database& from, const Database& into, const std::map<std::string, std::int64_t>& least,
              SalvageNote& note);

}  // namespace strainwave::bench
