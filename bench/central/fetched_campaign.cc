// SPDX-License-Identifier: Apache-2.0
#include "bench/central/fetched_campaign.h"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/central/journal_rows.h"
#include "bench/json_text.h"
#include "daq/synced_folder.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFetchOf = "WHERE month = $1 AND bench_id = $2 AND campaign_id = $3";

// Gone again unless it is given its place.
class PartialFolder {
 public:
  explicit PartialFolder(fs::path folder) : folder_(std::move(folder)) {
    fs::remove_all(folder_);
    daq::MakeFolders(folder_);
  }
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;
  ~PartialFolder() {
    std::error_code gone;
    if (!folder_.empty()) fs::remove_all(folder_, gone);
  }
  const fs::path& path() const { return folder_; }
  void Place(const fs::path& as) {
    fs::rename(folder_, as);
    folder_.clear();
    daq::SyncFolderOf(as);
  }

 private:
  fs::path folder_;
};

void BindJson(Statement& statement, const nlohmann::json& value) {
  if (value.is_null()) {
    statement.BindNull();
  } else if (value.is_number_integer()) {
    statement.Bind(value.get<std::int64_t>());
  } else if (value.is_number()) {
    statement.Bind(value.get<double>());
  } else {
    statement.Bind(std::string_view(value.get_ref<const std::string&>()));
  }
}

void InsertRow(const Database& database, std::string_view table, const nlohmann::json& row) {
  std::string places = "?";
  for (std::size_t i = 1; i < row.size(); ++i) places += ", ?";
  Statement insert = database.Prepare(fmt::format("INSERT INTO {} VALUES({})", table, places));
  for (const nlohmann::json& value : row) BindJson(insert, value);
  insert.Run();
}

void BindReal(Statement& statement, const ServerRows& rows, int row, int column) {
  if (rows.IsNull(row, column)) {
    statement.BindNull();
  } else {
    statement.Bind(rows.Real(row, column));
  }
}

class Fetch {
 public:
  Fetch(Server& server, const FoundCampaign& campaign)
      : server_(server), here_{campaign.month, campaign.bench_id, campaign.campaign_id} {}

  void WriteJournal(Journal& journal) {
    const Database& database = journal.database();
    Transaction transaction(database);
    for (const char* table : {"campaign", "chain", "results", "phases", "cycles"})
      database.Execute(fmt::format("DELETE FROM {}", table));
    WriteCycles(database);
    WriteResults(database);
    WriteRows(
        database, "alarms",
        server_.Run(fmt::format("SELECT journal_row FROM strainwave.alarms {} ORDER BY number", kFetchOf),
                    here_));
    const auto of_table = [&](std::string_view table) {
      std::vector<ServerValue> values = here_;
      values.emplace_back(table);
      WriteRows(
          database, table,
          server_.Run(fmt::format("SELECT journal_row FROM strainwave.journal_rows {} AND journal_table = "
                                  "$4::strainwave.journal_table ORDER BY number, key",
                                  kFetchOf),
                      values));
    };
    for (const std::string_view table : GrowingTables()) of_table(table);
    for (const std::string_view table : NamedTables()) of_table(table);
    transaction.Commit();
  }

  std::optional<std::string> Input(const std::string& sha256) {
    const ServerRows rows =
        server_.Run("SELECT encode(content, 'hex') FROM strainwave.inputs WHERE sha256 = $1", {sha256});
    if (rows.count() == 0) return std::nullopt;
    const std::string hex = rows.Text(0, 0);
    std::string bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
      bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
    return bytes;
  }

  int Records(const RecordStore& store, const CampaignFolder& folder, std::vector<std::string>& warnings) {
    const ServerRows rows = server_.Run(
        fmt::format(
            "SELECT DISTINCT ON (path) path, sha256 FROM strainwave.records {} ORDER BY path, arrived DESC",
            kFetchOf),
        here_);
    int records = 0;
    for (int i = 0; i < rows.count(); ++i) {
      // A row of the server must not lead out of the folder.
      const fs::path path = fs::path(rows.Text(i, 0)).lexically_normal();
      if (path.is_absolute() || path.empty() || *path.begin() == "..") continue;
      daq::MakeFolders((folder.root / path).parent_path());
      if (store.Fetch(rows.Text(i, 1), folder.root / path)) {
        ++records;
      } else {
        warnings.push_back(fmt::format("{}: the store has it not, or damaged", path.string()));
      }
    }
    return records;
  }

 private:
  static void WriteRows(const Database& database, std::string_view table, const ServerRows& rows) {
    for (int i = 0; i < rows.count(); ++i) InsertRow(database, table, ParseUnorderedJson(rows.View(i, 0)));
  }

  void WriteCycles(const Database& database) {
    const ServerRows rows =
        server_.Run(fmt::format("SELECT cycle, outcome, started_s, ended_s, records_sha256, phases FROM "
                                "strainwave.cycles {} ORDER BY "
                                "cycle",
                                kFetchOf),
                    here_);
    for (int i = 0; i < rows.count(); ++i) {
      Statement insert = database.Prepare(
          "INSERT INTO cycles(cycle, outcome, started_s, ended_s, records_sha256) VALUES(?, ?, ?, ?, ?)");
      insert.Bind(rows.Integer(i, 0)).Bind(rows.View(i, 1)).Bind(rows.Real(i, 2));
      BindReal(insert, rows, i, 3);
      insert.Bind(rows.View(i, 4)).Run();
      for (const nlohmann::json& phase : ParseUnorderedJson(rows.View(i, 5)))
        InsertRow(database, "phases", phase);
    }
  }

  // A row a result: the server takes the arrays apart.
  void WriteResults(const Database& database) {
    const ServerRows rows = server_.Run(
        fmt::format(
            "SELECT r.cycle, r.repeat, u.quantity, u.value, u.standard_error, coalesce(r.flags[u.place], '') "
            "FROM (SELECT * FROM strainwave.result_rows {}) r JOIN strainwave.quantity_sets q USING "
            "(quantity_set) CROSS JOIN LATERAL unnest(q.names, r.result_values, r.standard_errors) WITH "
            "ORDINALITY AS u(quantity, value, standard_error, place)",
            kFetchOf),
        here_);
    Statement insert = database.Prepare("INSERT INTO results VALUES(?, ?, ?, ?, ?, ?)");
    for (int i = 0; i < rows.count(); ++i) {
      insert.Bind(rows.Integer(i, 0)).Bind(rows.Integer(i, 1)).Bind(rows.View(i, 2));
      BindReal(insert, rows, i, 3);
      BindReal(insert, rows, i, 4);
      insert.Bind(rows.View(i, 5)).Run();
    }
  }

  Server& server_;
  std::vector<ServerValue> here_;
};

}  // namespace

FetchedCampaign FetchCampaign(Server& server, const FoundCampaign& campaign, const fs::path& into,
                              const RecordStore* store) {
  FetchedCampaign fetched{into / campaign.Name(), campaign.complete, 0, {}};
  if (fs::exists(fetched.folder))
    Refuse(fetched.folder, "is there already", "another folder, or none of that name");
  daq::MakeFolders(into);
  PartialFolder partial(into / ("." + campaign.Name() + ".partial"));
  const CampaignFolder folder{partial.path()};
  // All of one moment, whatever is forwarded meanwhile.
  ServerTransaction transaction(server);
  server.Execute("SET TRANSACTION ISOLATION LEVEL REPEATABLE READ READ ONLY");
  Fetch fetch(server, campaign);
  {
    Journal journal = Journal::Create(folder.Journal());
    fetch.WriteJournal(journal);
    for (const FrozenFile& frozen : FrozenFiles(folder)) {
      const std::string sha256 = journal.Property(frozen.property).value_or("");
      if (sha256.empty()) continue;
      const auto bytes = fetch.Input(sha256);
      if (!bytes) {
        throw BenchError(
            ExitCode::kWrongInput,
            fmt::format("{}: error: the server does not have its {} (expected that of a whole forwarding)",
                        campaign.Name(), frozen.file.filename().string()));
      }
      daq::WriteFileAtomically(frozen.file, *bytes);
    }
  }
  if (!campaign.caught_up)
    fetched.warnings.push_back("is being forwarded: its last rows may be missing, and its chain be cut");
  if (store != nullptr) fetched.records = fetch.Records(*store, folder, fetched.warnings);
  partial.Place(fetched.folder);
  return fetched;
}

}  // namespace strainwave::bench
