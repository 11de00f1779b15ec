// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// What was done, seen or written, with its link in the chain (`journal_chain.h`).
struct TrailEntry {
  std::int64_t link{};  // number
  std::string kind;     // "property", "event", "hole", "note", "alarm action"
  std::string utc;
  std::string who;   // "the program"; "a person", whom the text names; or a name
  std::string what;  // in words
  std::string sha256;
};

/// All but cycles and files, in the order in which they were chained; empty in journals of earlier versions,
/// which have no chain. @throws DatabaseError.
std::vector<TrailEntry> TrailOf(const Journal& journal);

/// Phases that did not end by themselves.
struct CutPhases {
  int load_runs{};
  int others{};
  double kept_load_s{};   // credited before the cut, and not run again
  int cycles{};           // in which they are
  int cycles_complete{};  // of these
};
CutPhases CutPhasesOf(const Journal& journal);

}  // namespace strainwave::bench
