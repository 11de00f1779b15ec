// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/journal_chain.h"

#include <array>
#include <bit>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "bench/sha256.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kBrokenShown = 20;
const std::string kLinkBeforeTheFirst(64, '0');

struct ChainedKind {
  const char* name;
  const char* keys;                 // of all its rows, in the order in which they were written
  std::array<const char*, 3> rows;  // of one key; empty at the end
};

// In the order of ChainedRow. Columns by name, in this order for ever: a later version may have more of them.
constexpr std::array kKinds{
    ChainedKind{
        "property",
        "SELECT key FROM campaign WHERE key IN ('format', 'schedule_name', 'schedule_sha256', "
        "'bench_sha256', 'plant_sha256', 'commissioned_sha256', 'bench_folder', 'device_files_sha256', "
        "'started_utc', 'specimen') ORDER BY key",
        {"SELECT key, value FROM campaign WHERE key = ?"}},
    ChainedKind{
        "cycle",
        "SELECT cycle FROM cycles WHERE outcome = 'complete' ORDER BY cycle",
        {"SELECT cycle, outcome, started_s, ended_s, records_sha256 FROM cycles WHERE cycle = ?",
         "SELECT id, cycle, step, repeat, attempt, name, kind, started_s, ended_s, outcome, "
         "credited_load_s FROM phases WHERE cycle = ? ORDER BY id",
         "SELECT cycle, repeat, quantity, value, standard_error, flag FROM results WHERE cycle = ? ORDER "
         "BY repeat, quantity"}},
    ChainedKind{"event",
                "SELECT id FROM events ORDER BY id",
                {"SELECT id, time_s, utc, cycle, phase, severity, code, text FROM events WHERE id = ?"}},
    ChainedKind{
        "hole",
        "SELECT id FROM holes ORDER BY id",
        {"SELECT id, cycle, phase, time_s, start_utc, end_utc, cause, clock FROM holes WHERE id = ?"}},
    ChainedKind{"note",
                "SELECT id FROM operator_notes ORDER BY id",
                {"SELECT id, utc, author, text FROM operator_notes WHERE id = ?"}},
    ChainedKind{"alarm action",
                "SELECT id FROM alarm_actions ORDER BY id",
                {"SELECT id, number, utc, author, action, text FROM alarm_actions WHERE id = ?"}},
    ChainedKind{"file",
                "SELECT id FROM files ORDER BY id",
                {"SELECT id, path, bytes, sha256 FROM files WHERE id = ?"}},
};

const ChainedKind& KindOf(ChainedRow row) { return kKinds.at(static_cast<std::size_t>(row)); }

void AppendNumber(std::string& bytes, std::uint64_t number) {
  for (int shift = 0; shift < 64; shift += 8) bytes += static_cast<char>(number >> shift & 0xffU);
}

void AppendColumn(std::string& bytes, const Statement& row, int column) {
  switch (row.TypeOf(column)) {
    case Statement::Type::kNull:
      bytes += 'N';
      return;
    case Statement::Type::kInteger:
      bytes += 'I';
      AppendNumber(bytes, static_cast<std::uint64_t>(row.Integer(column)));
      return;
    case Statement::Type::kReal:
      bytes += 'R';
      AppendNumber(bytes, std::bit_cast<std::uint64_t>(row.Real(column)));
      return;
    case Statement::Type::kText:
      const std::string text = row.Blob(column);
      bytes += 'T';
      AppendNumber(bytes, text.size());
      bytes += text;
      return;
  }
}

// The rows of one kind, by key; their statements are prepared once.
class RowsOfKind {
 public:
  RowsOfKind(const Database& database, const ChainedKind& kind) {
    for (const char* sql : kind.rows) {
      if (sql != nullptr) statements_.push_back(database.Prepare(sql));
    }
  }

  // Nothing where there is no such row.
  std::optional<std::string> Bytes(std::string_view key) {
    std::string bytes;
    bool found = false;
    for (Statement& statement : statements_) {
      statement.Bind(key);
      while (statement.Step()) {
        found = found || &statement == &statements_.front();
        bytes += 'r';
        for (int column = 0; column < statement.Columns(); ++column) AppendColumn(bytes, statement, column);
      }
      statement.Reset();
    }
    return found ? std::optional(std::move(bytes)) : std::nullopt;
  }

 private:
  std::vector<Statement> statements_;
};

std::string LinkAfter(std::string before, std::string_view kind, std::string_view key,
                      std::string_view rows) {
  before.append(kind).append(1, '\0').append(key).append(1, '\0').append(rows);
  return Sha256(before);
}

bool HasTable(const Database& database, std::string_view name) {
  Statement statement = database.Prepare("SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = ?");
  statement.Bind(name);
  return statement.Step();
}

std::vector<std::string> KeysOf(const Database& database, const ChainedKind& kind) {
  Statement statement = database.Prepare(kind.keys);
  std::vector<std::string> keys;
  while (statement.Step()) keys.push_back(statement.Text(0));
  return keys;
}

std::int64_t LinksOf(const Database& database, const ChainedKind& kind) {
  Statement statement = database.Prepare("SELECT COUNT(DISTINCT key) FROM chain WHERE kind = ?");
  statement.Bind(std::string_view(kind.name));
  statement.Step();
  return statement.Integer(0);
}

void Append(const Database& database, const ChainedKind& kind, std::string_view key, RowsOfKind& rows) {
  const auto bytes = rows.Bytes(key);
  Statement last = database.Prepare("SELECT sha256 FROM chain ORDER BY number DESC LIMIT 1");
  const std::string before = last.Step() ? last.Text(0) : kLinkBeforeTheFirst;
  last.Reset();
  database.Prepare("INSERT INTO chain(kind, key, sha256) VALUES(?, ?, ?)")
      .Bind(std::string_view(kind.name))
      .Bind(key)
      .Bind(std::string_view(LinkAfter(before, kind.name, key, bytes.value_or(""))))
      .Run();
}

}  // namespace

bool HasChain(const Database& database) { return HasTable(database, "chain"); }

void BeginChain(const Database& database) {
  database.Execute(
      "CREATE TABLE IF NOT EXISTS files(id INTEGER PRIMARY KEY, path TEXT NOT NULL, bytes INTEGER NOT NULL, "
      "sha256 TEXT NOT NULL)");
  database.Execute(
      "CREATE TABLE chain(number INTEGER PRIMARY KEY, kind TEXT NOT NULL, key TEXT NOT NULL, sha256 TEXT NOT "
      "NULL)");
  AddAllLinks(database);
}

void AddAllLinks(const Database& database) {
  for (std::size_t i = 0; i < kKinds.size(); ++i) AddLinks(database, static_cast<ChainedRow>(i));
}

void AddLinks(const Database& database, ChainedRow row) {
  const ChainedKind& kind = KindOf(row);
  RowsOfKind rows(database, kind);
  for (const std::string& key : KeysOf(database, kind)) Append(database, kind, key, rows);
}

void AddLink(const Database& database, ChainedRow row, std::string_view key) {
  const ChainedKind& kind = KindOf(row);
  RowsOfKind rows(database, kind);
  Append(database, kind, key, rows);
}

ChainReport CheckChain(const Database& database) { return CheckChain(database, database, kBrokenShown); }

ChainReport CheckChain(const Database& chain, const Database& database, std::size_t most) {
  ChainReport report;
  report.head = kLinkBeforeTheFirst;
  std::map<std::string, RowsOfKind> rows;
  for (const ChainedKind& kind : kKinds) rows.try_emplace(kind.name, database, kind);
  const auto take_broken = [&](std::int64_t number, std::string what, std::string why) {
    ++report.broken_links;
    if (report.broken.size() < most) report.broken.push_back({number, std::move(what), std::move(why)});
  };
  Statement links = chain.Prepare("SELECT number, kind, key, sha256 FROM chain ORDER BY number");
  while (links.Step()) {
    const std::int64_t number = links.Integer(0);
    const std::string kind = links.Text(1);
    const std::string key = links.Text(2);
    const std::string sha256 = links.Text(3);
    ++report.links;
    if (number != report.links) {
      take_broken(report.links, fmt::format("link {}", report.links), "it is missing");
      report.links = number;
    }
    const auto found = rows.find(kind);
    const auto bytes = found == rows.end() ? std::nullopt : found->second.Bytes(key);
    if (!bytes) {
      take_broken(number, fmt::format("{} {}", kind, key), "its row is missing");
    } else if (LinkAfter(report.head, kind, key, *bytes) != sha256) {
      take_broken(number, fmt::format("{} {}", kind, key),
                  "its row, or the link before it, is not the one that was chained");
    }
    // From what stands there, so that one changed row is one broken link.
    report.head = sha256;
  }
  for (const ChainedKind& kind : kKinds) {
    const auto without = static_cast<std::int64_t>(KeysOf(database, kind).size()) - LinksOf(chain, kind);
    if (without > 0) report.unchained[kind.name] = without;
  }
  return report;
}

}  // namespace strainwave::bench
