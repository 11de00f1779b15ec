// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/campaign/database.h"
#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// How far the server has a campaign's journal: of what only grows, the last number.
struct JournalMarks {
  int cycle{-1};                              // last complete one
  std::map<std::string, std::int64_t> table;  // "events" → 31
};

/// A cycle as the server keeps it.
struct SentCycle {
  int cycle{};
  std::string outcome;
  double started_s{};
  std::optional<double> ended_s;
  std::string records_sha256;
  std::string phases;  // JSON: an array of the rows, each an array of its columns
};

/// Results of one cycle and repeat, in the order of their quantities.
struct SentResults {
  int cycle{};
  int repeat{};
  std::vector<std::string> quantities;
  std::vector<std::optional<double>> values;
  std::vector<std::optional<double>> standard_errors;
  std::vector<std::string> flags;
};

struct SentAlarm {
  AlarmInstance instance;
  std::string row;  // JSON: its columns
};

/// A row of the other tables, whole.
struct SentRow {
  std::string table;
  std::int64_t number{};  // 0 where a name is the key
  std::string key;
  std::string row;  // JSON: its columns
};

/// What of a journal the server lacks, all of one moment.
struct JournalBatch {
  std::vector<SentCycle> cycles;
  std::vector<SentResults> results;
  std::vector<SentAlarm> alarms;
  std::vector<SentRow> rows;
  bool is_last{};  // nothing is left after it

  bool IsEmpty() const { return cycles.empty() && results.empty() && alarms.empty() && rows.empty(); }
};

/// A file of a campaign, as its journal has it.
struct JournalFile {
  std::string path;  // from the campaign's folder on
  std::string sha256;
};

/// How far the files of a journal have been looked at.
struct JournalFileMarks {
  int cycle{-1};  // last complete one
  std::int64_t file{};
};

/// Tables whose rows are only ever added, by number, and those whose rows change, by name.
std::span<const std::string_view> GrowingTables();
std::span<const std::string_view> NamedTables();
/// Columns of a table that this program's journals have; zero where the journal lacks it.
int ColumnsOf(const Database& database, std::string_view table);

/// What comes after the marks, at most about so many rows of each kind: what has changed of alarms,
/// properties, calibrations and the cycle under way is always in it. Reads one moment of the journal and lets
/// go of it, so that a run beside it is not kept from tidying its write-ahead log. @throws DatabaseError.
JournalBatch ReadBatch(const Journal& journal, const JournalMarks& marks, int most_cycles);

/// Raw records of complete cycles and the other files that the journal has after the marks, which move on to
/// its end. Of a file that is registered anew the last one counts; those without a digest are left out.
/// @throws DatabaseError.
std::vector<JournalFile> FilesAfter(const Database& database, JournalFileMarks& marks);

}  // namespace strainwave::bench
