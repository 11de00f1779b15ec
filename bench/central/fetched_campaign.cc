// SPDX-License-Identifier: Apache-2.0
#include "bench/central/fetched_campaign.h"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/central/journal_rows.h"
#include "bench/errors/output_path.h"
#include "bench/json_text.h"
#include "daq/file_descriptor.h"
#include "daq/synced_folder.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kMostNamed = 10;  // files that are missing; of more, how many
constexpr const char* kFetchOf = "WHERE month = $1 AND bench_id = $2 AND campaign_id = $3";

[[noreturn]] void RefuseTaken(const fs::path& place) {
  Refuse(place, "is there already", "another folder, or none of that name");
}

// Of one program at a time, and gone again unless it is given its place. What a killed one has left is taken
// over: the kernel lets go of its lock.
class PartialFolder {
 public:
  explicit PartialFolder(const fs::path& place)
      : place_(place), folder_(place.parent_path() / ("." + place.filename().string() + ".partial")) {
    daq::MakeFolders(folder_);
    lock_ = daq::FileDescriptor(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!IsOurs()) {
      folder_.clear();
      Refuse(place_, "another program fetches it at this moment", "that to be done, or another folder");
    }
    for (const auto& left : fs::directory_iterator(folder_)) fs::remove_all(left.path());
    if (!fs::exists(place_)) return;
    fs::remove_all(folder_);
    RefuseTaken(place_);
  }
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;
  ~PartialFolder() {
    std::error_code gone;
    if (!folder_.empty()) fs::remove_all(folder_, gone);
  }
  const fs::path& path() const { return folder_; }
  void Place() {
    std::error_code failure;
    fs::rename(folder_, place_, failure);
    if (failure == std::errc::directory_not_empty || failure == std::errc::file_exists) RefuseTaken(place_);
    if (failure) throw fs::filesystem_error("cannot place", folder_, place_, failure);
    folder_.clear();
    daq::SyncFolderOf(place_);
  }

 private:
  // A file system without locks leaves it to whoever fetches.
  bool IsOurs() const {
    if (!lock_.is_open()) return false;
    if (::flock(lock_.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
    // By its name it may have got its place meanwhile, or be a later one.
    return daq::LeadsTo(folder_, lock_.get());
  }

  fs::path place_;
  fs::path folder_;
  daq::FileDescriptor lock_{-1};
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

  // Those that the journal has, and those of the server that it does not know.
  void Records(const RecordStore& store, const CampaignFolder& folder, const std::vector<JournalFile>& known,
               FetchedCampaign& fetched) {
    std::map<std::string, std::string> files;
    const ServerRows rows = server_.Run(
        fmt::format(
            "SELECT DISTINCT ON (path) path, sha256 FROM strainwave.records {} ORDER BY path, arrived DESC",
            kFetchOf),
        here_);
    for (int i = 0; i < rows.count(); ++i) files[rows.Text(i, 0)] = rows.Text(i, 1);
    for (const JournalFile& file : known) files[file.path] = file.sha256;
    for (const auto& [name, sha256] : files) {
      // A row of the server must not lead out of the folder.
      const fs::path path = fs::path(name).lexically_normal();
      if (path.is_absolute() || path.empty() || *path.begin() == "..") continue;
      daq::MakeFolders((folder.root / path).parent_path());
      if (store.Fetch(sha256, folder.root / path)) {
        ++fetched.records;
      } else if (++fetched.missing <= kMostNamed) {
        fetched.warnings.push_back(fmt::format("{}: the store has it not, or damaged", path.string()));
      }
    }
    if (fetched.missing > kMostNamed) {
      fetched.warnings.push_back(
          fmt::format("{} more files: the store has them not, or damaged", fetched.missing - kMostNamed));
    }
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

void DemandFetchPlace(const fs::path& into, const std::vector<FoundCampaign>& campaigns) {
  if (into.empty()) Refuse("--out", "is empty", "a folder for campaigns");
  DemandOutputFolder(into);
  const fs::path whole = fs::absolute(into).lexically_normal();
  for (fs::path above = whole; above.has_relative_path(); above = above.parent_path()) {
    const CampaignFolder folder{above};
    if (fs::exists(folder.Journal()) && fs::exists(folder.Schedule()))
      Refuse(into, "is a campaign's folder, or lies in one", "a folder for campaigns, one below it for each");
  }
  for (const FoundCampaign& one : campaigns) {
    if (fs::exists(into / one.Name())) RefuseTaken(into / one.Name());
  }
}

FetchedCampaign FetchCampaign(Server& server, const FoundCampaign& campaign, const fs::path& into,
                              const RecordStore* store) {
  FetchedCampaign fetched{into / campaign.Name(), campaign.complete, 0, 0, {}};
  DemandFetchPlace(into, {campaign});
  PartialFolder partial(fetched.folder);
  const CampaignFolder folder{partial.path()};
  // All of one moment, whatever is forwarded meanwhile.
  ServerTransaction transaction(server);
  server.Execute("SET TRANSACTION ISOLATION LEVEL REPEATABLE READ READ ONLY");
  Fetch fetch(server, campaign);
  std::vector<JournalFile> files;
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
    JournalFileMarks from_the_first;
    files = FilesAfter(journal.database(), from_the_first);
  }
  if (!campaign.caught_up)
    fetched.warnings.push_back("is being forwarded: its last rows may be missing, and its chain be cut");
  if (!campaign.same_as.empty()) {
    fetched.warnings.push_back(
        fmt::format("is the campaign {} again, forwarded by another bench", campaign.same_as));
  }
  if (store != nullptr) fetch.Records(*store, folder, files, fetched);
  partial.Place();
  return fetched;
}

}  // namespace strainwave::bench
