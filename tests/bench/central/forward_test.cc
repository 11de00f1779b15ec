// SPDX-License-Identifier: Apache-2.0
// What comes to the server is what the journal has, row by row, and once.
#include <gtest/gtest.h>

#include <fstream>

#include "bench/central/server_columns.h"
#include "bench/page/page_state.h"
#include "tests/bench/central/lab.h"

namespace strainwave::bench::forward_test {
namespace {

class Forwarding : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
    lab_ = std::make_unique<Lab>();
    campaign_ = std::make_unique<WrittenCampaign>(lab_->scratch / "campaign");
  }
  std::unique_ptr<Lab> lab_;
  std::unique_ptr<WrittenCampaign> campaign_;
};

TEST_F(Forwarding, BringsTheJournalRowByRow) {
  campaign_->AddCycles(9);
  campaign_->RaiseAlarm("2026-12-01T10:00:00.000Z");
  campaign_->journal().AddOperatorNote({"2026-12-01T10:00:00.000Z", "A. Meier", "grease"});
  campaign_->journal().AddHole(
      {3, "load", 300.0, "2026-12-01T10:00:00.000Z", "2026-12-01T11:00:00.000Z", "kill", "utc"});
  campaign_->journal().SetCalibration({"tilt", 0.1, 0.01, "rad", "blank"}, "2026-12-01T10:00:00.000Z");
  campaign_->BeginCycle(9);
  auto order = lab_->Order(campaign_->folder());
  order.settings.cycles_per_batch = 2;
  lab_->Forward(order);
  const auto rows = RowsOf(campaign_->folder());
  EXPECT_GT(rows.size(), 80U);
  EXPECT_EQ(RowsOf(lab_->Fetched("fetched")), rows);
  EXPECT_EQ(ReadText(lab_->Fetched("again").Schedule()), ReadText(campaign_->folder().Schedule()));
  // By another way than the one that writes folders.
  EXPECT_EQ(lab_->Value("SELECT count(*) FROM strainwave.results"), "29");
  EXPECT_EQ(
      lab_->Value("SELECT value FROM strainwave.results WHERE cycle = 7 AND quantity = 'k1_Nm_per_rad' AND "
                  "repeat = 0"),
      "15002.645751311065");
  EXPECT_EQ(lab_->Value("SELECT flag FROM strainwave.results WHERE cycle = 3 AND quantity = 'e_max_arcmin'"),
            "too few \"turns\"\t\\N, éß");
}

TEST_F(Forwarding, TwiceChangesNothing) {
  campaign_->AddCycles(5);
  campaign_->RaiseAlarm("2026-12-01T10:00:00.000Z");
  const auto order = lab_->Order(campaign_->folder());
  lab_->Forward(order);
  // Of every row the transaction that wrote it last.
  const std::string all =
      "SELECT string_agg(x, ' ' ORDER BY x) FROM (SELECT format('%s %s %s', tableoid::regclass, ctid, xmin) "
      "x FROM "
      "strainwave.cycles UNION ALL SELECT format('%s %s %s', tableoid::regclass, ctid, xmin) FROM "
      "strainwave.result_rows UNION ALL SELECT format('%s %s %s', tableoid::regclass, ctid, xmin) FROM "
      "strainwave.journal_rows UNION ALL SELECT format('%s %s %s', tableoid::regclass, ctid, xmin) FROM "
      "strainwave.alarms UNION ALL SELECT format('%s %s %s', tableoid::regclass, ctid, xmin) FROM "
      "strainwave.campaigns) y";
  const std::string before = lab_->Value(all);
  const auto told = lab_->Forward(order);
  EXPECT_EQ(lab_->Value(all), before);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told[0].find("bench hall-3: 0 cycles and 0 rows brought"), std::string::npos) << told[0];
}

TEST_F(Forwarding, GoesOnWithWhatARunAdds) {
  campaign_->AddCycles(2);
  campaign_->BeginCycle(2);
  const std::int64_t alarm = campaign_->RaiseAlarm("2026-12-01T10:00:00.000Z");
  const auto order = lab_->Order(campaign_->folder());
  lab_->Forward(order);
  EXPECT_EQ(lab_->Value("SELECT outcome FROM strainwave.cycles WHERE cycle = 2"), "running");
  EXPECT_EQ(lab_->Value("SELECT state FROM strainwave.alarms"), "raised");
  campaign_->journal().EndCycle(2, 299.0, "complete", std::string(64, 'a'));
  campaign_->AddCycles(2);
  AlarmInstance changed = campaign_->journal().Alarms(-1.0).at(0);
  ASSERT_EQ(changed.number, alarm);
  changed.acknowledged_by = "A. Meier";
  changed.returned_utc = "2026-12-01T10:05:00.000Z";
  campaign_->journal().StoreAlarm(changed);
  campaign_->journal().SetProperty("cycles", "20");
  lab_->Forward(order);
  EXPECT_EQ(RowsOf(lab_->Fetched("fetched")), RowsOf(campaign_->folder()));
  EXPECT_EQ(lab_->Value("SELECT acknowledged_by FROM strainwave.alarms"), "A. Meier");
  EXPECT_EQ(lab_->Value("SELECT caught_up FROM strainwave.campaigns"), "t");
}

TEST_F(Forwarding, KeepsRecordsByWhatTheyHold) {
  campaign_->AddCycles(3);
  auto order = lab_->Order(campaign_->folder());
  order.settings.store = lab_->scratch / "store";
  std::ofstream(campaign_->folder().CycleFile(1), std::ios::app) << "one bit more";
  const auto told = lab_->Forward(order);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0], fmt::format("warning: {}: is not what the journal says of it: not kept in the store",
                                 campaign_->folder().CycleFile(1).string()));
  const std::string digest = Sha256("records of cycle 2");
  EXPECT_EQ(WholeFile(order.settings.store / digest.substr(0, 2) / digest), "records of cycle 2");
  EXPECT_EQ(lab_->Value("SELECT count(*) FROM strainwave.records"), "2");
  const RecordStore store(order.settings.store);
  EXPECT_EQ(ReadText(lab_->Fetched("fetched", &store).CycleFile(2)), "records of cycle 2");
}

// Of which the server knows long since: a store that was lost, or is another one, is filled again.
TEST_F(Forwarding, FillsAStoreThatLacksRecords) {
  campaign_->AddCycles(3);
  auto order = lab_->Order(campaign_->folder());
  order.settings.store = lab_->scratch / "first";
  lab_->Forward(order);
  order.settings.store = lab_->scratch / "second";
  std::filesystem::remove(campaign_->folder().CycleFile(1));
  const auto told = lab_->Forward(order);
  EXPECT_EQ(told.size(), 1U) << told.front();
  const std::string digest = Sha256("records of cycle 2");
  EXPECT_EQ(WholeFile(order.settings.store / digest.substr(0, 2) / digest), "records of cycle 2");
}

// What it has looked at once, it does not ask the journal for again.
TEST_F(Forwarding, LooksAtTheRecordsOfNewCyclesAlone) {
  campaign_->AddCycles(3);
  auto settings = lab_->Order(campaign_->folder()).settings;
  settings.store = lab_->scratch / "store";
  CampaignForward forward(campaign_->folder(), settings);
  ServerSource source(lab_->postgres.Conninfo("bench_hall-3"), {});
  EXPECT_EQ(forward.Look(source).records, 3);
  // To whoever looks at the first cycle again, its file is not what the journal says.
  campaign_->journal().database().Execute(
      fmt::format("UPDATE cycles SET records_sha256 = '{}' WHERE cycle = 0", std::string(64, 'a')));
  campaign_->AddCycles(2);
  const Forwarded second = forward.Look(source);
  EXPECT_EQ(second.records, 2);
  EXPECT_EQ(second.troubles, std::vector<std::string>{});
}

TEST_F(Forwarding, MarksStampsOfAWrongClock) {
  campaign_->AddCycles(1);
  campaign_->RaiseAlarm("2026-12-01T10:00:00.000Z");
  campaign_->RaiseAlarm("2126-12-01T10:00:00.000Z");
  auto order = lab_->Order(campaign_->folder());
  lab_->Forward(order);
  // The second is of a day to come, whatever the clock says now.
  EXPECT_EQ(lab_->Value("SELECT string_agg(clock_wrong::text, ' ' ORDER BY number) FROM strainwave.alarms"),
            "false true");
  campaign_->RaiseAlarm("2026-12-01T10:00:00.000Z");
  order.settings.utc_ms = [] { return UtcMilliseconds() - std::int64_t{3} * 86'400'000; };
  const auto told = lab_->Forward(order);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told[0],
            "warning: the clock of this machine is 3.0 days behind that of the server (expected: less than "
            "one); its "
            "stamps are marked as wrong there");
  EXPECT_EQ(lab_->Value("SELECT clock_wrong FROM strainwave.alarms WHERE number = 3"), "t");
  EXPECT_EQ(lab_->Value("SELECT clock_wrong FROM strainwave.bench_states"), "t");
  // The server's own stamp beside it is of now.
  EXPECT_EQ(lab_->Value("SELECT arrived > now() - interval '1 hour' FROM strainwave.alarms WHERE number = 3"),
            "t");
}

TEST(Columns, AreAsPostgresqlReadsThem) {
  ServerColumns columns;
  const std::optional<double> numbers[] = {0.1, std::nullopt, std::numeric_limits<double>::infinity()};
  const std::string flags[] = {"a\"b", "", "c"};
  columns.Text("x\"\\").Integer(-3).Real(std::nullopt).Reals(numbers).Texts(flags).EndRow();
  columns.Text("").Integer(4).Real(0.5).Null().Null().EndRow();
  const std::vector<ServerValue> expected{"1",
                                          R"({"x\"\\",""})",
                                          "{-3,4}",
                                          "{NULL,0.5}",
                                          R"({"{0.1,NULL,Infinity}",NULL})",
                                          R"({"{\"a\\\"b\",NULL,\"c\"}",NULL})"};
  EXPECT_EQ(columns.After({"1"}), expected);
  EXPECT_EQ(ServerText(std::string("a\0\xff"
                                   "b",
                                   4)),
            "a\uFFFD\uFFFD"
            "b");
}

TEST(Backoff, GrowsAndIsBounded) {
  EXPECT_EQ(WaitsBeforeAttempt(1, 0.0), 1.0);
  EXPECT_EQ(WaitsBeforeAttempt(4, 0.0), 8.0);
  EXPECT_EQ(WaitsBeforeAttempt(4, 1.0), 4.0);
  EXPECT_EQ(WaitsBeforeAttempt(1'000'000, 0.0), 60.0);
}

}  // namespace
}  // namespace strainwave::bench::forward_test
