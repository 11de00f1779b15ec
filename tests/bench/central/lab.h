// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "bench/campaign/campaign.h"
#include "bench/campaign/journal.h"
#include "bench/central/campaign_query.h"
#include "bench/central/fetched_campaign.h"
#include "bench/central/forward_loop.h"
#include "bench/central/roles.h"
#include "bench/sha256.h"
#include "bench/utc.h"
#include "daq/whole_file.h"
#include "tests/bench/central/postgres.h"
#include "tests/checkout.h"
#include "tests/simulation/program.h"

namespace strainwave {

/// A campaign's folder as a run leaves it, written without one.
class WrittenCampaign {
 public:
  explicit WrittenCampaign(const std::filesystem::path& folder)
      : folder_{folder},
        journal_(bench::CreateCampaign(
            folder_, bench::ReadInputs(SourceFolder() + "/schedules/quick.yaml", std::nullopt))) {
    std::filesystem::create_directories(folder_.Cycles());
  }

  const bench::CampaignFolder& folder() const { return folder_; }
  bench::Journal& journal() { return journal_; }

  void AddCycles(int count) {
    for (int i = 0; i < count; ++i) AddCycle();
  }
  void AddCycle() {
    const int cycle = journal_.LastCompleteCycle() + 1;
    const double begun_s = 100.0 * cycle;
    BeginCycle(cycle);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    journal_.AddResults(
        cycle, 0,
        {{"k1_Nm_per_rad", 15000.0 + std::sqrt(cycle), 61.7 / 3.0, ""},
         {"e_max_arcmin", 0.1 * cycle, 1e-300, cycle % 3 == 0 ? "too few \"turns\"\t\\N, éß" : ""},
         {"lost_motion_arcmin", nan, nan, "nothing to measure"}});
    if (cycle % 4 == 1) journal_.AddResults(cycle, 1, {{"k1_Nm_per_rad", 1.0 / 3.0, nan, ""}});
    const std::string records = fmt::format("records of cycle {}", cycle);
    daq::WriteFileAtomically(folder_.CycleFile(cycle), records);
    journal_.EndCycle(cycle, begun_s + 99.5, "complete", bench::Sha256(records));
    journal_.AddEvent(
        {begun_s, "2026-12-01T10:00:00.000Z", cycle, "cycle", "info", "cycle", "line\nof\ttext \\", 0});
  }
  void BeginCycle(int cycle) {
    journal_.BeginCycle(cycle, 100.0 * cycle);
    const std::int64_t phase =
        journal_.BeginPhase({0, cycle, 1, 0, 0, "load", "load_run", 100.0 * cycle, 0.0, "running", 0.0});
    if (cycle % 2 == 0) journal_.EndPhase(phase, 100.0 * cycle + 50.1, "complete", 49.3);
  }
  std::int64_t RaiseAlarm(const std::string& utc) {
    bench::AlarmInstance alarm;
    alarm.code = "twist_limit";
    alarm.text = "twist beyond its limit";
    alarm.cycle = 1;
    alarm.raised_s = alarm.last_raised_s = 12.5;
    alarm.raised_utc = alarm.last_raised_utc = utc;
    journal_.StoreAlarm(alarm);
    return alarm.number;
  }

 private:
  bench::CampaignFolder folder_;
  bench::Journal journal_;
};

/// All rows of all tables of a journal, a line each, in an order of their own.
inline std::vector<std::string> RowsOf(const bench::CampaignFolder& folder) {
  const bench::Database database(folder.Journal(), bench::Database::Mode::kReadOnly);
  std::vector<std::string> tables;
  bench::Statement names =
      database.Prepare("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name");
  while (names.Step()) tables.push_back(names.Text(0));
  std::vector<std::string> rows;
  for (const std::string& table : tables) {
    bench::Statement statement = database.Prepare(fmt::format("SELECT * FROM {}", table));
    while (statement.Step()) {
      std::string row = table;
      for (int column = 0; column < statement.Columns(); ++column) {
        row += statement.IsNull(column) ? "|NULL"
               : statement.TypeOf(column) == bench::Statement::Type::kReal
                   ? fmt::format("|{:a}", statement.Real(column))
                   : fmt::format("|{}", statement.Text(column));
      }
      rows.push_back(row);
    }
  }
  std::ranges::sort(rows);
  return rows;
}

/// However long it takes; CTest ends a test that hangs.
template <typename Condition>
void Until(const Condition& condition) {
  while (!condition()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

/// Forwards quickly, and looks again at once.
inline bench::ForwardOrder OrderOf(const bench::CampaignFolder& folder, const std::string& conninfo) {
  bench::ForwardOrder order;
  order.folders = {folder.root.string()};
  order.conninfo = conninfo;
  order.settings.utc_ms = bench::UtcMilliseconds;
  order.first_wait_s = 0.05;
  order.round_s = 0.05;
  return order;
}

/// One server for all tests of a process, since to make one takes a second.
inline std::shared_ptr<PostgresServer> SharedServer() {
  static const auto server = std::make_shared<PostgresServer>();
  return server;
}

/// A server with a new database and its tables, a bench "hall-3", and folders.
struct Lab {
  explicit Lab(std::shared_ptr<PostgresServer> of = SharedServer())
      : server(std::move(of)), postgres(*server) {
    postgres.MakeLab();
    AddBench("hall-3");
  }
  void AddBench(const std::string& name) {
    bench::Server admin(postgres.Conninfo("admin"));
    bench::MakeRole(admin, {bench::RoleKind::kBench, name, scratch / (name + ".pgpass"), false, false});
  }
  bench::ForwardOrder Order(const bench::CampaignFolder& folder, const std::string& name = "hall-3") const {
    bench::ForwardOrder order = OrderOf(folder, postgres.Conninfo("bench_" + name));
    order.settings.machine = "machine of " + name;
    return order;
  }
  /// Once. @return what was told.
  std::vector<std::string> Forward(const bench::ForwardOrder& order) const {
    std::vector<std::string> told;
    bench::RunForward(
        order, [] { return false; }, [&](const std::string& line) { told.push_back(line); });
    return told;
  }
  /// The one campaign that the server has, written anew.
  bench::CampaignFolder Fetched(const std::string& into, const bench::RecordStore* store = nullptr) const {
    bench::Server admin(postgres.Conninfo("admin"));
    const auto found = bench::FindCampaigns(admin, bench::ParseCampaignQuery(""));
    return {bench::FetchCampaign(admin, found.at(0), scratch / into, store).folder};
  }
  std::string Value(const std::string& sql) const {
    bench::Server admin(postgres.Conninfo("admin"));
    return admin.Run(sql).Text(0, 0);
  }

  ScratchFolder scratch;
  std::shared_ptr<PostgresServer> server;
  PostgresServer& postgres;
};

/// What a refusal says, without the words about where; with the exit code.
inline std::string RefusalOf(const std::function<void()>& what) {
  try {
    what();
  } catch (const bench::BenchError& error) {
    const std::string text = error.what();
    const std::size_t at = text.find("error: ");
    return fmt::format("{}: {}", static_cast<int>(error.exit_code()),
                       at == text.npos ? text : text.substr(at + 7));
  }
  return "none";
}

}  // namespace strainwave
