// SPDX-License-Identifier: Apache-2.0
// Who may do what at the server, and what is refused in which words.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include "tests/bench/central/lab.h"

namespace strainwave::bench::rights_test {
namespace {

class Rights : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
    lab_ = std::make_unique<Lab>();
    campaign_ = std::make_unique<WrittenCampaign>(lab_->scratch / "campaign");
    campaign_->AddCycles(2);
  }
  std::string Said(const std::string& role, const std::string& sql) {
    return RefusalOf([&] { Server(lab_->postgres.Conninfo(role)).Execute(sql); });
  }
  std::unique_ptr<Lab> lab_;
  std::unique_ptr<WrittenCampaign> campaign_;
};

TEST_F(Rights, ABenchWritesAndSeesItsOwnRowsOnly) {
  lab_->AddBench("hall-4");
  lab_->Forward(lab_->Order(campaign_->folder()));
  Server other(lab_->postgres.Conninfo("bench_hall-4"));
  for (const char* table :
       {"campaigns", "bench_states", "cycles", "result_rows", "alarms", "journal_rows", "records"}) {
    EXPECT_EQ(other.Run(fmt::format("SELECT count(*) FROM strainwave.{}", table)).Text(0, 0), "0") << table;
  }
  EXPECT_EQ(Said("bench_hall-4",
                 "INSERT INTO strainwave.cycles(month, bench_id, campaign_id, cycle, outcome, started_s, "
                 "records_sha256, "
                 "phases) SELECT date_trunc('month', now())::date, 1, 1, 77, 'complete', 0, '', '[]'"),
            "2: new row violates row-level security policy for table \"cycles\"");
  EXPECT_EQ(other.Run("UPDATE strainwave.cycles SET outcome = 'x'").affected(), 0);
  EXPECT_EQ(Said("bench_hall-4", "DELETE FROM strainwave.cycles"), "2: permission denied for table cycles");
  // Past the table's own policy there is no way by its parts.
  const std::string part = lab_->Value("SELECT min(tableoid::regclass::text) FROM strainwave.cycles");
  EXPECT_EQ(Said("bench_hall-4", "SELECT * FROM " + part),
            fmt::format("2: permission denied for table {}", part.substr(part.find('.') + 1)));
  EXPECT_EQ(Said("bench_hall-4", "UPDATE strainwave.benches SET role = session_user"),
            "2: permission denied for table benches");
  // The server's own stamp is not for benches to give.
  EXPECT_EQ(Said("bench_hall-3", "UPDATE strainwave.cycles SET arrived = now()"),
            "2: permission denied for table cycles");
}

TEST_F(Rights, AReaderSeesAllAndWritesNothing) {
  lab_->Forward(lab_->Order(campaign_->folder()));
  Server admin(lab_->postgres.Conninfo("admin"));
  MakeRole(admin, {RoleKind::kReader, "office", lab_->scratch / "office.pgpass", false, false});
  Server reader(lab_->postgres.Conninfo("reader_office"));
  EXPECT_EQ(reader.Run("SELECT count(*) FROM strainwave.results").Text(0, 0), "7");
  EXPECT_EQ(Said("reader_office", "UPDATE strainwave.cycles SET outcome = 'x'"),
            "2: permission denied for table cycles");
  EXPECT_EQ(Said("reader_office", "SELECT strainwave.keep_input('x')"),
            "2: permission denied for function keep_input");
  EXPECT_EQ(RefusalOf([&] {
              auto order = lab_->Order(campaign_->folder());
              order.conninfo = lab_->postgres.Conninfo("reader_office");
              lab_->Forward(order);
            }).substr(0, 22),
            "2: permission denied f");
}

TEST_F(Rights, WhoIsNoBenchForwardsNothing) {
  auto order = lab_->Order(campaign_->folder());
  order.conninfo = lab_->postgres.Conninfo("admin");
  EXPECT_EQ(RefusalOf([&] { lab_->Forward(order); }),
            "2: admin is not the role of a bench (expected that of one, which strainwave central add-bench "
            "NAME makes)");
}

TEST_F(Rights, TwoMachinesUnderOneNameAreRefused) {
  auto order = lab_->Order(campaign_->folder());
  lab_->Forward(order);
  order.settings.machine = "another machine";
  EXPECT_EQ(RefusalOf([&] { lab_->Forward(order); }),
            "2: bench hall-3 is forwarded by another machine already (expected a name for each bench; where "
            "its machine "
            "was replaced: strainwave central add-bench hall-3 --new-machine)");
  Server admin(lab_->postgres.Conninfo("admin"));
  MakeRole(admin, {RoleKind::kBench, "hall-3", {}, false, true});
  EXPECT_EQ(RefusalOf([&] { lab_->Forward(order); }), "none");
}

TEST_F(Rights, TablesOfANewerVersionAreRefused) {
  Server admin(lab_->postgres.Conninfo("admin"));
  admin.Execute("INSERT INTO strainwave.versions VALUES (9, 'of a later program')");
  const std::string words =
      "2: the server's tables are of version 9, which is newer than this program (expected 2 at most: a "
      "newer "
      "strainwave on this machine)";
  EXPECT_EQ(RefusalOf([&] { lab_->Forward(lab_->Order(campaign_->folder())); }), words);
  EXPECT_EQ(RefusalOf([&] { Migrate(admin); }), words);
}

TEST_F(Rights, TablesOfAnOlderVersionAreBroughtUp) {
  Server maintenance(lab_->postgres.Conninfo("admin", "postgres"));
  maintenance.Execute("DROP DATABASE IF EXISTS old WITH (FORCE)");
  maintenance.Execute("CREATE DATABASE old");
  Server old(lab_->postgres.Conninfo("admin", "old"));
  EXPECT_EQ(RefusalOf([&] { DemandSchema(old); }),
            "2: the server has no tables of strainwave that this role may use (expected those of strainwave "
            "central "
            "migrate, and a role of add-bench or add-reader)");
  EXPECT_EQ(Migrate(old, 1), std::vector<int>{1});
  EXPECT_EQ(RefusalOf([&] { DemandSchema(old); }),
            "2: the server's tables are of version 1, which is older than this program (expected 2: "
            "strainwave central "
            "migrate)");
  old.Execute("INSERT INTO strainwave.benches(name, role) VALUES ('kept', 'bench_kept')");
  EXPECT_EQ(Migrate(old), std::vector<int>{2});
  EXPECT_EQ(Migrate(old), std::vector<int>{});
  EXPECT_EQ(old.Run("SELECT name FROM strainwave.benches").Text(0, 0), "kept");
}

TEST_F(Rights, PasswordsAreForTheOwnerOfTheFileAlone) {
  const std::filesystem::path file = lab_->scratch / "hall-3.pgpass";
  struct stat entry {};
  ASSERT_EQ(::stat(file.c_str(), &entry), 0);
  EXPECT_EQ(entry.st_mode & 0777, 0600U);
  const std::string line = ReadText(file);
  EXPECT_EQ(line.substr(0, 19), "*:*:*:bench_hall-3:");
  // What the server was told is not it.
  EXPECT_EQ(lab_->Value("SELECT starts_with(rolpassword, 'SCRAM-SHA-256$') FROM pg_authid WHERE rolname = "
                        "'bench_hall-3'"),
            "t");
  EXPECT_EQ(ReadText(lab_->postgres.folder() / "log").find(line.substr(19, 48)), std::string::npos);
  EXPECT_EQ(RefusalOf([] { CheckConninfo("host=db.lab password=secret"); }),
            "2: has a password, which everybody on this machine can read there (expected it in ~/.pgpass, or "
            "in the file "
            "that passfile=FILE or PGPASSFILE names)");
  EXPECT_EQ(
      RefusalOf([&] { lab_->AddBench("a b"); }),
      "2: 'a b' is no name of a bench or reader (expected letters, digits, '_', '-' and '.', 50 at most)");
  EXPECT_EQ(RefusalOf([&] { lab_->AddBench("hall-3"); }),
            "2: there is a role bench_hall-3 already (expected another name, or --new-password)");
}

}  // namespace
}  // namespace strainwave::bench::rights_test
