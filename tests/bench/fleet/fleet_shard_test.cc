// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/shard.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "bench/fleet/collect.h"
#include "bench/fleet/fleet_status.h"
#include "bench/fleet/kept_results.h"
#include "tests/bench/fleet/fleet_helpers.h"

namespace strainwave::bench::fleet_shard_test {
namespace {

std::vector<std::string> Records(const std::vector<std::string>& texts) {
  std::vector<std::string> names;
  for (const std::string& text : texts) {
    names.push_back("r" + std::to_string(names.size()) + ".csv");
    FleetFolder::Write(names.back(), text);
  }
  return names;
}

void ComputeAll(const FleetFolder& folder, const std::string& name, std::size_t jobs = 1) {
  RunAllShards(folder.At(name), ReadPlan(folder.At(name)), folder.program(), jobs, [](std::size_t) {});
}

std::string CollectedText(const FleetFolder& folder, const std::string& name) {
  return CollectResults(folder.At(name), ReadPlan(folder.At(name))).document.dump(1);
}

// Bytes and times of all results.
std::map<std::string, std::pair<std::string, std::filesystem::file_time_type>> ResultsOf(
    const PlanFolder& plan) {
  std::map<std::string, std::pair<std::string, std::filesystem::file_time_type>> results;
  for (const auto& entry : std::filesystem::directory_iterator(plan.Results()))
    results[entry.path().filename()] = {WholeFile(entry.path()), entry.last_write_time()};
  return results;
}

TEST(FleetShard, ComputesWhatIsNotThereAlone) {
  const FleetFolder folder;
  const FleetPlan plan = folder.Planned("plan", Records({"a", "b", "c", "fails"}), 2);
  ShardEnd end = RunShard(folder.At("plan"), plan, folder.program(), 0);
  EXPECT_EQ(end.kept, 2U);
  const auto once = ResultsOf(folder.At("plan"));
  EXPECT_EQ(once.size(), 2U);
  end = RunShard(folder.At("plan"), plan, folder.program(), 0);
  EXPECT_EQ(end.kept, 0U);
  EXPECT_EQ(end.were_there, 2U);
  EXPECT_EQ(ResultsOf(folder.At("plan")), once);
  EXPECT_EQ(ToldBy([&] { RunShard(folder.At("plan"), plan, folder.program(), 2); }),
            "2 " + folder.Path("plan/plan.json") + ": error: has no shard 2 (expected 0 to 1)");
}

TEST(FleetShard, LeavesNoTraceOfHowItWasCut) {
  const FleetFolder folder;
  const auto records = Records({"a", "b", "fails here", "refused", "d", "e", "f"});
  folder.Planned("one", records, 1);
  folder.Planned("many", records, 5);
  ComputeAll(folder, "one");
  ComputeAll(folder, "many", 3);
  EXPECT_EQ(CollectedText(folder, "one"), CollectedText(folder, "many"));
}

TEST(FleetShard, MayRunTwiceAtOnce) {
  const FleetFolder folder;
  const auto records = Records({"a", "b", "c", "refused", "d", "e", "f", "g", "h"});
  const FleetPlan plan = folder.Planned("twice", records, 1);
  folder.Planned("once", records, 1);
  ShardEnd other_end;
  {
    const std::jthread other([&] { other_end = RunShard(folder.At("twice"), plan, folder.program(), 0); });
    const ShardEnd end = RunShard(folder.At("twice"), plan, folder.program(), 0);
    EXPECT_EQ(end.kept + end.were_there, records.size());
  }
  EXPECT_EQ(other_end.kept + other_end.were_there, records.size());
  ComputeAll(folder, "once");
  EXPECT_EQ(CollectedText(folder, "twice"), CollectedText(folder, "once"));
  for (const auto& [name, result] : ResultsOf(folder.At("twice")))
    EXPECT_EQ(name.size(), 64U + 5U) << name << " is no result's name";
}

TEST(FleetShard, IsGoneOnWithAfterAKill) {
  const FleetFolder folder;
  const auto records = Records({"a", "b", "c", "waits", "d", "e", "f"});
  ASSERT_EQ(::mkfifo("fifo", 0600), 0);
  const FleetPlan plan = folder.Planned("plan", records, 1);
  const pid_t shard = ::fork();
  if (shard == 0) {
    RunShard(folder.At("plan"), plan, folder.program(), 0);
    ::_exit(0);
  }
  const int writer = ::open("fifo", O_WRONLY);  // comes back when the program has the record in hand
  EXPECT_TRUE(ShardMark::IsHeld(folder.At("plan"), 0));
  EXPECT_EQ(StatusOf(folder.At("plan"), plan).running, 4U);
  ::kill(shard, SIGKILL);
  ::waitpid(shard, nullptr, 0);
  EXPECT_FALSE(ShardMark::IsHeld(folder.At("plan"), 0));
  const FleetStatus status = StatusOf(folder.At("plan"), plan);
  EXPECT_EQ(status.done, 3U);
  EXPECT_EQ(status.missing, 4U);
  ::close(writer);
  // What would have been read from the pipe is nobody's concern now.
  std::filesystem::remove("fifo");
  FleetFolder::Write("fifo", "go\n");
  ComputeAll(folder, "plan");
  folder.Planned("whole", records, 1);
  ComputeAll(folder, "whole");
  EXPECT_EQ(CollectedText(folder, "plan"), CollectedText(folder, "whole"));
}

TEST(FleetShard, RefusesAChangedRecord) {
  const FleetFolder folder;
  const FleetPlan plan = folder.Planned("plan", Records({"a", "b"}), 1);
  FleetFolder::Write("r1.csv", "B");
  ShardEnd end = RunShard(folder.At("plan"), plan, folder.program(), 0);
  EXPECT_EQ(end.kept, 1U);
  EXPECT_EQ(end.changed, 1U);
  const std::string told = "r1.csv: error: has changed since the plan was made: its SHA-256 is " +
                           Sha256("B") + " (1 bytes) (expected SHA-256 " + Sha256("b") +
                           ", 1 bytes; a new plan for what it is now)";
  EXPECT_EQ(end.first_words, told);
  const FleetStatus status = StatusOf(folder.At("plan"), plan);
  EXPECT_EQ(status.failed, 1U);
  ASSERT_EQ(status.open.size(), 1U);
  EXPECT_EQ(status.open[0].words, told);
  std::filesystem::remove("r1.csv");
  end = RunShard(folder.At("plan"), plan, folder.program(), 0);
  EXPECT_EQ(end.first_words,
            "r1.csv: error: has changed since the plan was made: it is not there (expected SHA-256 " +
                Sha256("b") + ", 1 bytes; a new plan for what it is now)");
  FleetFolder::Write("r1.csv", "b");
  ComputeAll(folder, "plan");
  EXPECT_EQ(StatusOf(folder.At("plan"), plan).done, 2U);
  EXPECT_TRUE(std::filesystem::is_empty(folder.At("plan").Failures()));
}

TEST(FleetShard, RefusesARecordThatChangesWhileItIsRead) {
  const FleetFolder folder;
  const FleetPlan plan = folder.Planned("plan", Records({"grows"}), 1);
  EXPECT_EQ(RunShard(folder.At("plan"), plan, folder.program(), 0).changed, 1U);
  EXPECT_TRUE(std::filesystem::is_empty(folder.At("plan").Results()));
}

TEST(FleetShard, RefusesAnotherProgram) {
  const FleetFolder folder;
  const FleetPlan plan = folder.Planned("plan", Records({"a"}), 1);
  FleetProgram other = folder.program();
  other.sha256 = "abc";
  EXPECT_NE(ToldBy([&] { RunShard(folder.At("plan"), plan, other, 0); }).find("another program than this"),
            std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder.At("plan").Results()));
}

TEST(FleetShard, TriesAgainWhereTheMachineFailed) {
  const FleetFolder folder;
  const auto records = Records({"killed", "broken"});
  const FleetPlan plan = folder.Planned("plan", records, 1);
  const ShardEnd end = RunShard(folder.At("plan"), plan, folder.program(), 0);
  EXPECT_EQ(end.failed, 2U);
  EXPECT_EQ(end.changed, 0U);
  const FleetStatus status = StatusOf(folder.At("plan"), plan);
  EXPECT_EQ(status.open.at(0).words, "r0.csv: the program was ended by signal 9");
  EXPECT_EQ(status.open.at(1).words, "r1.csv: exit code 3: the disk is full");
  EXPECT_EQ(OpenShards(status), std::vector<std::size_t>{0});
}

TEST(FleetShard, ComputesADamagedResultAgain) {
  const FleetFolder folder;
  const FleetPlan plan = folder.Planned("plan", Records({"a"}), 1);
  ComputeAll(folder, "plan");
  const auto file = folder.At("plan").Results() / (plan.inputs[0].key + ".json");
  const std::string whole = WholeFile(file);
  for (const std::string& damaged : {whole.substr(0, whole.size() / 2), std::string(), "x" + whole}) {
    FleetFolder::Write(file, damaged);
    EXPECT_EQ(StatusOf(folder.At("plan"), plan).missing, 1U);
    ComputeAll(folder, "plan");
    EXPECT_EQ(WholeFile(file), whole);
  }
  std::string other = whole;
  other.replace(other.find("\"text\":\"a"), 9, "\"text\":\"b");
  FleetFolder::Write(file, other);
  EXPECT_EQ(StatusOf(folder.At("plan"), plan).missing, 1U);
}

TEST(FleetCollect, SaysWhatIsMissing) {
  const FleetFolder folder;
  const FleetPlan plan = folder.Planned("plan", Records({"a", "b", "c", "d", "e", "f", "killed"}), 7);
  RunShard(folder.At("plan"), plan, folder.program(), plan.inputs[6].shard);
  const auto shard = [&](std::size_t i) { return std::to_string(plan.inputs[i].shard); };
  std::string lines;
  for (std::size_t i = 0; i < 5; ++i)
    lines += "  r" + std::to_string(i) + ".csv (shard " + shard(i) + "): no result yet\n";
  EXPECT_EQ(ToldBy([&] { CollectResults(folder.At("plan"), plan); }),
            "1 " + folder.Path("plan") +
                ": error: 7 of 7 records have no result (expected all; strainwave fleet submit --out " +
                folder.Path("plan") + " computes what is missing)\n" + lines + "  and 2 more\n");
}

TEST(FleetCollect, KeepsThePlansOrderAndSumsInIt) {
  const FleetFolder folder;
  folder.Planned("plan", Records({"aaa", "refused", "b", "fails"}), 3);
  ComputeAll(folder, "plan");
  const Collected all = CollectResults(folder.At("plan"), ReadPlan(folder.At("plan")));
  EXPECT_EQ(all.ended_badly, 1U);
  EXPECT_EQ(all.refused, 1U);
  const auto& inputs = all.document.at("inputs");
  EXPECT_EQ(inputs.at(0).at("report").at("text"), "aaa");
  EXPECT_EQ(inputs.at(1).at("error"), "r1.csv: error: refused (expected a record)");
  EXPECT_EQ(inputs.at(3).at("exit_code"), 1);
  const auto& length = all.document.at("over_records").at("length");
  EXPECT_EQ(length.at("count"), 3);
  EXPECT_EQ(length.at("mean"), 3.0);                // of 3, 1 and 5
  EXPECT_EQ(length.at("standard_deviation"), 2.0);  // of the same
  EXPECT_EQ(CsvOf(all.document),
            "path,sha256,exit_code,error,text,length,options\n"
            "r0.csv," +
                Sha256("aaa") +
                ",0,,aaa,3,\n"
                "r1.csv," +
                Sha256("refused") +
                ",2,r1.csv: error: refused (expected a record),,,\n"
                "r2.csv," +
                Sha256("b") +
                ",0,,b,1,\n"
                "r3.csv," +
                Sha256("fails") + ",1,,fails,5,\n");
}

}  // namespace
}  // namespace strainwave::bench::fleet_shard_test
