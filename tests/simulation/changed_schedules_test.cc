// SPDX-License-Identifier: Apache-2.0
// Small campaigns with one thing changed in their schedule.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/journal.h"
#include "tests/simulation/campaign_program.h"
#include "tests/simulation/program.h"

namespace strainwave::changed_schedules_test {
namespace {

/// The small schedule with one text put in the place of another.
std::string Changed(const ScratchFolder& scratch, const std::string& from, const std::string& to) {
  std::string text = WholeFile(kSchedule);
  text.replace(text.find(from), from.size(), to);
  const std::string schedule = (scratch / "changed.yaml").string();
  std::ofstream(schedule) << text;
  return schedule;
}

TEST(Validate, WarnsOfAStiffnessThatIncludesTheBench) {
  const ScratchFolder scratch;
  const std::string blank =
      "preparation:\n  - kind: blank_test\n    peak_torque: 34 Nm\n    torque_rate: 10 Nm/s\n    steps: 36\n";
  const std::string schedule = Changed(scratch, blank, "");
  const ProgramResult result = RunProgram({"validate", schedule});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.error,
            schedule +
                ":65:1: warning: the stiffness will include the twist of couplings and sensor (a "
                "blank_test in preparation measures and removes it)\n");
  EXPECT_EQ(RunProgram({"validate", kSchedule}).error, "");
}

TEST(StopCriterion, EndsTheCampaignWithExitCodeOne) {
  const ScratchFolder scratch;
  const std::string schedule =
      Changed(scratch, "measurements:", "stop:\n  e_max_above: 0.5 arcmin\nmeasurements:");
  const auto folder = scratch / "campaign";
  const ProgramResult result = RunProgram({"run", schedule, "--out", folder.string()});
  EXPECT_EQ(result.exit_code, 1) << result.error;
  const auto journal = bench::Journal::Open(folder / "campaign.db", bench::Database::Mode::kReadOnly);
  EXPECT_EQ(journal.LastCompleteCycle(), 1);
  EXPECT_EQ(journal.Events(1).front().code, "stop_criterion");
}

TEST(Limit, TripsTheBenchKeepsTheSamplesAndTheCampaignCanGoOn) {
  const ScratchFolder scratch;
  // The locked bench winds up by more than this at the peak of the blank test.
  const std::string schedule = Changed(scratch, "twist: 30 arcmin", "twist: 5 arcmin");
  const auto folder = scratch / "campaign";
  const ProgramResult result = RunProgram({"run", schedule, "--out", folder.string()});
  EXPECT_EQ(result.exit_code, 1) << result.error;
  const std::vector<std::string> told{
      "arcmin is beyond the limit of 5.00 arcmin with the input locked (limits.twist) [output encoder ",
      "the channels before and after it: " + (folder / "faults").string(),
      "stopped: torque is off, brakes are on; when the cause is mended, go on with: strainwave run " +
          schedule + " --out " + folder.string() + " --resume\n"};
  for (const std::string& words : told) {
    EXPECT_NE(result.error.find(words), std::string::npos) << words << "\n" << result.error;
  }
  const auto status = nlohmann::json::parse(RunProgram({"status", folder.string(), "--json"}).out);
  ASSERT_EQ(status["alarms"].size(), 1u);
  EXPECT_EQ(status["alarms"][0]["code"], "twist_limit");
  EXPECT_FALSE(std::filesystem::is_empty(folder / "faults"));
}

}  // namespace
}  // namespace strainwave::changed_schedules_test
