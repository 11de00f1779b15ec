// SPDX-License-Identifier: Apache-2.0
#include "bench/integrity/salvage_rows.h"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include <fmt/core.h>

namespace strainwave::bench {
namespace {

enum class Keys {
  kNumbered,  // by an integer without gaps, given by SQLite
  kIntegers,  // by an integer that may be absent, or stand in several rows
  kTexts,     // few rows
};

struct Table {
  const char* name;
  const char* key;
  Keys keys;
};

constexpr std::array kTables{
    Table{"campaign", "key", Keys::kTexts},      Table{"cycles", "cycle", Keys::kIntegers},
    Table{"phases", "id", Keys::kNumbered},      Table{"results", "cycle", Keys::kIntegers},
    Table{"events", "id", Keys::kNumbered},      Table{"holes", "id", Keys::kNumbered},
    Table{"calibrations", "name", Keys::kTexts}, Table{"operator_notes", "id", Keys::kNumbered},
    Table{"alarms", "number", Keys::kNumbered},  Table{"alarm_actions", "id", Keys::kNumbered},
    Table{"files", "id", Keys::kNumbered},
};

// Above every number of a row.
constexpr std::int64_t kPastAll = std::int64_t{1} << 40;

class Copy {
 public:
  Copy(const Database& from, const Database& into, const Table& table)
      : from_(from), table_(table), columns_(ColumnsOf(into)), insert_(into.Prepare(InsertSql())) {}

  void Run() {
    if (table_.keys == Keys::kTexts) {
      // What lies behind a damaged page is reached from the other end.
      CopyTexts("ASC");
      CopyTexts("DESC");
      return;
    }
    std::int64_t next = -1;
    while (next < kPastAll) {
      const auto failed_after = CopyFrom(next);
      if (!failed_after) return;
      next = FirstReadableAfter(*failed_after);
    }
  }

  std::int64_t copied() const { return copied_; }
  std::int64_t largest() const { return largest_; }

 private:
  std::string ColumnsOf(const Database& into) const {
    Statement info = into.Prepare(
        fmt::format("SELECT group_concat(name, ', ') FROM pragma_table_info('{}')", table_.name));
    info.Step();
    return info.Text(0);
  }

  std::string InsertSql() const {
    std::string places = "?";
    for (const char letter : columns_) {
      if (letter == ',') places += ", ?";
    }
    return fmt::format("INSERT OR IGNORE INTO {}({}) VALUES({})", table_.name, columns_, places);
  }

  Statement Select(const char* where, const char* order) const {
    return from_.Prepare(fmt::format("SELECT {0}, {1} FROM {2} {3} ORDER BY {0} {4}", table_.key, columns_,
                                     table_.name, where, order));
  }

  void Insert(const Statement& row) {
    for (int column = 1; column < row.Columns(); ++column) {
      switch (row.TypeOf(column)) {
        case Statement::Type::kNull:
          insert_.BindNull();
          break;
        case Statement::Type::kInteger:
          insert_.Bind(row.Integer(column));
          break;
        case Statement::Type::kReal:
          insert_.Bind(row.Real(column));
          break;
        case Statement::Type::kText:
          insert_.Bind(std::string_view(row.Text(column)));
          break;
      }
    }
    insert_.Run();
    ++copied_;
  }

  // The last key that was read, where the rows after it cannot be.
  std::optional<std::int64_t> CopyFrom(std::int64_t key) {
    std::int64_t last = key - 1;
    try {
      Statement rows = Select(fmt::format("WHERE {} >= ?", table_.key).c_str(), "ASC");
      rows.Bind(key);
      while (rows.Step()) {
        last = rows.Integer(0);
        largest_ = std::max(largest_, last);
        Insert(rows);
      }
      return std::nullopt;
    } catch (const DatabaseError&) {
      return last;
    }
  }

  bool CanRead(std::int64_t key) const {
    try {
      Statement rows = Select(fmt::format("WHERE {} >= ?", table_.key).c_str(), "ASC LIMIT 1");
      rows.Bind(key);
      rows.Step();
      return true;
    } catch (const DatabaseError&) {
      return false;
    }
  }

  // Beyond the damaged page; past all keys where nothing is readable any more.
  std::int64_t FirstReadableAfter(std::int64_t last) const {
    std::int64_t step = 1;
    while (last + step < kPastAll && !CanRead(last + step)) step *= 2;
    std::int64_t bad = last + step / 2;
    std::int64_t good = last + step;
    while (bad + 1 < good) {
      const std::int64_t middle = bad + (good - bad) / 2;
      (CanRead(middle) ? good : bad) = middle;
    }
    return std::max(good, last + 1);
  }

  void CopyTexts(const char* order) {
    try {
      Statement rows = Select("", order);
      while (rows.Step()) {
        if (texts_.insert(rows.Text(0)).second) Insert(rows);
      }
    } catch (const DatabaseError&) {
      // The other end, or what there is.
    }
  }

  const Database& from_;
  const Table& table_;
  std::string columns_;
  Statement insert_;
  std::set<std::string> texts_;
  std::int64_t copied_{};
  std::int64_t largest_{};
};

}  // namespace

void CopyRows(const Database& from, const Database& into, const std::map<std::string, std::int64_t>& least,
              SalvageNote& note) {
  for (const Table& table : kTables) {
    std::int64_t copied = 0;
    std::int64_t largest = 0;
    try {
      Copy copy(from, into, table);
      copy.Run();
      copied = copy.copied();
      largest = copy.largest();
    } catch (const DatabaseError& error) {
      // A table that the journal of an earlier version lacks, or whose description cannot be read.
      if (error.code() != 1) throw;
    }
    if (const auto known = least.find(table.name); known != least.end())
      largest = std::max(largest, known->second);
    note.rows_recovered[table.name] = copied;
    if (table.keys == Keys::kNumbered && largest > copied) note.rows_lost[table.name] = largest - copied;
  }
}

}  // namespace strainwave::bench
