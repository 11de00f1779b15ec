// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/plan.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bench/fleet/collect.h"
#include "bench/fleet/fleet_command.h"
#include "bench/fleet/plan_files.h"
#include "bench/fleet/slurm.h"
#include "tests/bench/fleet/fleet_helpers.h"

namespace strainwave::bench::fleet_plan_test {
namespace {

std::vector<std::string> TwentyRecords() {
  std::vector<std::string> names;
  for (int i = 0; i < 20; ++i) {
    names.push_back("r" + std::to_string(i) + ".csv");
    FleetFolder::Write(names.back(), "record " + std::to_string(i));
  }
  return names;
}

std::map<std::string, std::size_t> ShardOfEach(const FleetPlan& plan) {
  std::map<std::string, std::size_t> shards;
  for (const PlannedInput& input : plan.inputs) shards[input.file.path] = input.shard;
  return shards;
}

TEST(FleetPlan, CutsShardsByHashWhateverTheOrder) {
  const FleetFolder folder;
  std::vector<std::string> names = TwentyRecords();
  const FleetPlan plan = MakePlan({"recompute", names, {}, 3}, folder.program());
  std::ranges::reverse(names);
  const FleetPlan reversed = MakePlan({"recompute", names, {}, 3}, folder.program());
  EXPECT_EQ(ShardOfEach(plan), ShardOfEach(reversed));
  EXPECT_EQ(reversed.inputs.front().file.path, "r19.csv");
  std::vector<std::size_t> sizes(3);
  for (const PlannedInput& input : plan.inputs) ++sizes.at(input.shard);
  std::ranges::sort(sizes);
  EXPECT_EQ(sizes, (std::vector<std::size_t>{6, 7, 7}));
}

TEST(FleetPlan, HasNoMoreShardsThanRecords) {
  const FleetFolder folder;
  EXPECT_EQ(MakePlan({"recompute", TwentyRecords(), {}, 100}, folder.program()).shards, 20U);
  EXPECT_EQ(MakePlan({"recompute", TwentyRecords(), {}, 0}, folder.program()).shards, 20U);
}

TEST(FleetPlan, NamesAResultByAllThatItRestsOn) {
  const FleetFolder folder;
  FleetFolder::Write("a.csv", "one");
  FleetFolder::Write("b.csv", "one");
  FleetFolder::Write("map.yaml", "map: 1");
  std::set<std::string> keys;
  const auto add = [&](const FleetProgram& program, const std::string& command,
                       const std::vector<std::string>& options, const std::string& record) {
    keys.insert(MakePlan({command, {record}, options, 1}, program).inputs.front().key);
  };
  add(folder.program(), "recompute", {}, "a.csv");
  add(folder.program(), "recompute", {}, "a.csv");
  EXPECT_EQ(keys.size(), 1U);
  add(folder.program(), "recompute", {}, "b.csv");
  add(folder.program(), "diagnose", {}, "a.csv");
  add(folder.program(), "recompute", {"--method", "loading"}, "a.csv");
  add(folder.program(), "recompute", {"--map", "map.yaml"}, "a.csv");
  FleetFolder::Write("map.yaml", "map: 2");
  add(folder.program(), "recompute", {"--map", "map.yaml"}, "a.csv");
  FleetProgram other = folder.program();
  other.sha256[0] = other.sha256[0] == '0' ? '1' : '0';
  add(other, "recompute", {}, "a.csv");
  FleetFolder::Write("a.csv", "two");
  add(folder.program(), "recompute", {}, "a.csv");
  EXPECT_EQ(keys.size(), 8U);
}

TEST(FleetPlan, IsReadAsItWasWritten) {
  const FleetFolder folder;
  const std::vector<std::string> names = TwentyRecords();
  const FleetPlan plan = folder.Planned("plan", names, 3);
  DemandSamePlan(folder.At("plan"), ReadPlan(folder.At("plan")), plan);
  const FleetPlan other = MakePlan({"recompute", names, {"--method", "loading"}, 3}, folder.program());
  EXPECT_EQ(
      ToldBy([&] { DemandSamePlan(folder.At("plan"), plan, other); }),
      "2 " + folder.Path("plan/plan.json") +
          ": error: is there already, of something else: recompute of 20 records (expected a new folder; or "
          "the same records, options, shards and working folder as then, which strainwave fleet submit "
          "without "
          "them takes from the plan)");
}

TEST(FleetPlan, RefusesAnotherProgram) {
  const FleetFolder folder;
  FleetFolder::Write("a.csv", "one");
  const FleetPlan plan = folder.Planned("plan", {"a.csv"}, 1);
  const FleetProgram other{"", "strainwave 9.9.9 (1111111)", "abc"};
  EXPECT_EQ(
      ToldBy([&] { DemandProgram(folder.At("plan"), plan, other); }),
      "2 " + folder.Path("plan/plan.json") +
          ": error: the plan was made for another program than this strainwave 9.9.9 (1111111), SHA-256 abc "
          "(expected strainwave 9.9.9 (0000000), SHA-256 " +
          folder.program().sha256 + "; or a new plan)");
  FleetProgram rebuilt = folder.program();
  rebuilt.sha256 = "abc";
  EXPECT_NE(ToldBy([&] { DemandProgram(folder.At("plan"), plan, rebuilt); }), "nothing");
}

TEST(FleetPlan, RefusesAPlanThatWasChanged) {
  const FleetFolder folder;
  FleetFolder::Write("a.csv", "one");
  folder.Planned("plan", {"a.csv"}, 1);
  std::string text = WholeFile("plan/plan.json");
  text.replace(text.find("recompute"), 9, "diagnosis");
  FleetFolder::Write("plan/plan.json", text);
  EXPECT_EQ(
      ToldBy([&] { ReadPlan(folder.At("plan")); }),
      "2 " + folder.Path("plan/plan.json") +
          ": error: the file has changed since it was written (expected the SHA-256 that it has of itself)");
  FleetFolder::Write("plan/plan.json", "{\"fleet_plan\": 2}");
  EXPECT_EQ(ToldBy([&] { ReadPlan(folder.At("plan")); }),
            "2 " + folder.Path("plan/plan.json") + ": error: it has format 2 (expected format 1)");
  FleetFolder::Write("plan/plan.json", "{");
  EXPECT_EQ(ToldBy([&] { ReadPlan(folder.At("plan")); }),
            "2 " + folder.Path("plan/plan.json") +
                ": error: is no plan (expected a plan, which strainwave fleet submit makes)");
}

TEST(FleetPlan, RefusesWhatHasNoResultOfItsOwn) {
  const FleetFolder folder;
  FleetFolder::Write("a.csv", "one");
  const auto told = [&](const std::string& command, const std::vector<std::string>& options) {
    return ToldBy([&] { MakePlan({command, {"a.csv"}, options, 1}, folder.program()); });
  };
  EXPECT_EQ(told("train", {}),
            "2 train: error: is no command that a fleet runs (expected recompute, features, diagnose)");
  EXPECT_EQ(
      told("recompute", {"--plots", "x"}),
      "2 --plots: error: is no option of recompute in a fleet (expected --method, --calibrations, --map)");
  EXPECT_EQ(told("recompute", {"--method"}), "2 --method: error: has no value (expected one behind it)");
  EXPECT_EQ(
      FilesOfOptions(FleetCommandNamed("diagnose"), std::vector<std::string>{"--power", "--model=m.yaml"}),
      std::vector<std::string>{"m.yaml"});
}

TEST(FleetPlan, LetsACycleRestOnItsCampaign) {
  const FleetFolder folder;
  std::filesystem::create_directories("c/cycles");
  FleetFolder::Write("c/campaign.db", "journal");
  FleetFolder::Write("c/schedule.yaml", "schedule: 1");
  FleetFolder::Write("c/cycles/000000.h5", "blank test");
  FleetFolder::Write("c/cycles/000002.h5", "two");
  FleetFolder::Write("c/cycles/000001.h5", "one");
  const FleetPlan plan = MakePlan({"recompute", {"c"}, {}, 1}, folder.program());
  ASSERT_EQ(plan.inputs.size(), 2U);
  EXPECT_EQ(plan.inputs[0].file.path, "c/cycles/000001.h5");
  ASSERT_EQ(plan.inputs[0].beside.size(), 2U);
  EXPECT_EQ(plan.inputs[0].beside[0].path, folder.Path("c/campaign.db"));
  SeenFiles files;
  DemandUnchanged(plan.inputs[0], files);
  FleetFolder::Write("c/campaign.db-wal", "");
  DemandUnchanged(plan.inputs[0], files);
  FleetFolder::Write("c/campaign.db-wal", "rows");
  EXPECT_EQ(
      ToldBy([&] { DemandUnchanged(plan.inputs[0], files); }),
      "2 " + folder.Path("c/campaign.db-wal") +
          ": error: was not there when the plan was made (expected the campaign as it was; a new plan for "
          "what it is now)");
}

TEST(FleetSlurm, WritesNumbersOfTasksAsRanges) {
  EXPECT_EQ(ArrayText(std::vector<std::size_t>{0, 1, 2, 5, 7, 8}), "0-2,5,7-8");
  EXPECT_EQ(ArrayText(std::vector<std::size_t>{3}), "3");
}

TEST(FleetPlan, IsMadeInAFolderOfItsOwn) {
  const FleetFolder folder;
  FleetFolder::Write("a.csv", "one");
  FleetFolder::Write("b.csv", "two");
  std::filesystem::create_directory("records");
  FleetFolder::Write("records/c.csv", "three");
  const FleetPlan plan = MakePlan({"recompute", {"a.csv"}, {}, 1}, folder.program());
  EXPECT_EQ(ToldBy([&] { WritePlan(folder.At("records"), plan); }),
            "2 " + folder.Path("records") +
                ": error: holds other files (expected a folder for the plan alone, empty or not there yet)");
  EXPECT_EQ(ToldBy([&] { WritePlan(folder.At("a.csv"), plan); }),
            "2 " + folder.Path("a.csv") + ": error: is no folder (expected a folder of the plan)");
  EXPECT_FALSE(std::filesystem::exists("records/results"));
  // Of two that are written at once the first one stays.
  WritePlan(folder.At("plan"), plan);
  WritePlan(folder.At("plan"), MakePlan({"recompute", {"b.csv"}, {}, 1}, folder.program()));
  EXPECT_EQ(ReadPlan(folder.At("plan")).inputs.front().file.path, "a.csv");
}

TEST(FleetTargets, WritesOverNothingThatThePlanRestsOn) {
  const FleetFolder folder;
  FleetFolder::Write("a.csv", "one");
  FleetFolder::Write("old.json", "{}");
  const FleetPlan plan = folder.Planned("plan", {"a.csv"}, 1);
  const auto told = [&](const std::vector<std::filesystem::path>& targets) {
    return ToldBy([&] { DemandTargets(folder.At("plan"), plan, targets); });
  };
  EXPECT_EQ(told({"old.json", "new.csv"}), "nothing");
  EXPECT_EQ(told({"new.json", "./a.csv"}),
            "2 ./a.csv: error: is a file that the plan reads (expected another one to write)");
  EXPECT_EQ(told({"r.json", "./r.json"}),
            "2 ./r.json: error: is named twice (expected a file each for document and table)");
  EXPECT_EQ(told({"plan/plan.json"}),
            "2 plan/plan.json: error: lies in the plan's folder (expected a file beside it)");
  EXPECT_EQ(told({"plan"}), "2 plan: error: is no file (expected the name of a file to write)");
  EXPECT_EQ(told({"none/r.json"}),
            "2 none/r.json: error: its folder is not there (expected a file in a folder that is)");
}

TEST(FleetSlurm, QuotesPathsForTheShell) {
  EXPECT_EQ(JobScriptText({"/a b/it's"}, "/usr/bin/strainwave"),
            "#!/bin/sh\n# One task of the array computes one shard; what is there already is left alone.\n"
            "exec '/usr/bin/strainwave' fleet shard '/a b/it'\\''s' \"$SLURM_ARRAY_TASK_ID\"\n");
}

// Lines as Slurm 22.05 writes them.
TEST(FleetSlurm, ReadsTasks) {
  const auto queue = TasksOfSqueue(
      "8|3|COMPLETED|None|n2\n8|0|PENDING|BeginTime|\n8|N/A|RUNNING|None|n1\nslurm_load_jobs error\n");
  ASSERT_EQ(queue.size(), 2U);
  EXPECT_EQ(queue[1].shard, 0U);
  EXPECT_EQ(queue[1].job, "8");
  EXPECT_EQ(queue[1].state, "PENDING");
  EXPECT_EQ(queue[1].reason, "BeginTime");
  const auto accounts =
      TasksOfSacct("8_3|COMPLETED|n2\n8_0|CANCELLED by 0|n1\n8_[4-6]|PENDING|\n9|FAILED|n1\n");
  ASSERT_EQ(accounts.size(), 2U);
  EXPECT_EQ(accounts[1].state, "CANCELLED");
  EXPECT_EQ(accounts[1].node, "n1");
  EXPECT_FALSE(MayStillRun("CANCELLED"));
  EXPECT_TRUE(MayStillRun("PENDING"));
}

}  // namespace
}  // namespace strainwave::bench::fleet_plan_test
