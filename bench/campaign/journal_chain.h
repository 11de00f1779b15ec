// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "bench/campaign/database.h"

namespace strainwave::bench {

/// A chain of hashes over those rows of a journal that never change once they are written
/// (docs/requirements.md R36), in its table `chain`:
///
///     link 0 = 64 zeros;  link n = SHA-256(link n−1, kind, NUL, key, NUL, rows), in hexadecimal
///     rows = for each row 'r' and its columns: 'N' | 'I' int64 | 'R' float64 | 'T' length (uint64), UTF-8
///
/// with little-endian numbers. Whoever changes, removes or inserts a row has to change every later link; a
/// head that was noted elsewhere (`strainwave verify` prints it) then does not match.
enum class ChainedRow {
  kProperty,     // of the campaign, fixed at its start: row of `campaign`
  kCycle,        // complete: row of `cycles`, and its rows of `phases` and `results`
  kEvent,        // row of `events`
  kHole,         // row of `holes`
  kNote,         // row of `operator_notes`
  kAlarmAction,  // row of `alarm_actions`
  kFile,         // row of `files`
};

/// Makes the table, with a link for each such row that is there already, as in journals of earlier versions.
/// In a transaction. @throws DatabaseError.
void BeginChain(const Database& database);
bool HasChain(const Database& database);

/// Appends the link of a row that has just been written. In the transaction that wrote it.
/// @param key  of the row: its number, name or path.
/// @throws DatabaseError.
void AddLink(const Database& database, ChainedRow kind, std::string_view key);

/// The same for all rows of a kind that are there, or of all kinds. @throws DatabaseError.
void AddLinks(const Database& database, ChainedRow kind);
void AddAllLinks(const Database& database);

struct BrokenLink {
  std::int64_t number{};
  std::string what;  // "event 31"
  std::string why;   // "its row is missing", "its row is not the one that was chained"
};

struct ChainReport {
  std::int64_t links{};
  std::string head;                               // of the last link
  std::int64_t broken_links{};                    // all of them
  std::vector<BrokenLink> broken;                 // the first 20
  std::map<std::string, std::int64_t> unchained;  // rows that have no link, by kind: "event" → 3
  bool IsWhole() const { return broken_links == 0 && unchained.empty(); }
};

/// Computes every link again. @throws DatabaseError.
ChainReport CheckChain(const Database& database);
/// The same of rows that were copied from the journal that has the chain; of each row by itself, wherever the
/// link before it can be read. @param most  links that are listed.
ChainReport CheckChain(const Database& chain, const Database& rows, std::size_t most);

}  // namespace strainwave::bench
