// SPDX-License-Identifier: Apache-2.0
// Campaigns that go on after a pause or a cut, and folders that are exchanged under them.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/mount.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include "bench/campaign/checkpoint.h"
#include "bench/campaign/journal.h"
#include "tests/simulation/campaign_program.h"
#include "tests/simulation/program.h"

namespace strainwave::campaign_resume_test {
namespace {

TEST(Resume, WarmsUpAfterALongPauseBeforeItMeasures) {
  const ScratchFolder scratch;
  std::string text = WholeFile(kSchedule);
  text.replace(text.find("re_soak_after: 30 min"), 21, "re_soak_after: 1 ms");
  const std::string schedule = (scratch / "short.yaml").string();
  std::ofstream(schedule) << text;
  const auto folder = scratch / "campaign";
  // Stops between the load run and the measurements: a shutdown cuts the rotation, which is then taken whole.
  const pid_t process = StartProgram({"run", schedule, "--out", folder.string(), "--pace", "200"}, scratch);
  WaitForPhase(folder, "measurement_rotation", process);
  ::kill(process, SIGTERM);
  ASSERT_EQ(WaitForProgram(process, scratch).exit_code, 130);
  ASSERT_EQ(RunProgram({"run", schedule, "--out", folder.string(), "--resume"}).exit_code, 0);
  const auto journal = bench::Journal::Open(folder / "campaign.db", bench::Database::Mode::kReadOnly);
  bool warmed_up = false;
  for (const bench::Event& event : journal.Events(100)) warmed_up = warmed_up || event.code == "warm_up";
  EXPECT_TRUE(warmed_up);
  double credited_s = 0.0;
  for (const bench::PhaseRow& row : journal.Phases(1)) credited_s += row.credited_load_s;
  EXPECT_NEAR(credited_s, 1200.0, 0.011);  // the warm-up is load, but not of the test
}

TEST(Resume, WarmsUpInFullAfterAPauseThatIsNotKnown) {
  const ScratchFolder scratch;
  const auto folder = scratch / "campaign";
  const pid_t process = StartProgram({"run", kSchedule, "--out", folder.string(), "--pace", "200"}, scratch);
  WaitForPhase(folder, "measurement_rotation", process);
  ::kill(process, SIGTERM);
  ASSERT_EQ(WaitForProgram(process, scratch).exit_code, 130);
  // The machine was started again since, with its clock five hours back.
  auto left = bench::ReadCheckpoint(folder / "checkpoint").value();
  left.written.boot ^= 1;
  left.written.utc_ms += 18'000'000;
  bench::CheckpointWriter(folder / "checkpoint").Write(left, left.machine_memory);
  const ProgramResult refused = RunProgram({"run", kSchedule, "--out", folder.string(), "--resume"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("how long the campaign has stood is not known"), std::string::npos)
      << refused.error;
  ASSERT_EQ(RunProgram({"run", kSchedule, "--out", folder.string(), "--resume", "--accept-pause"}).exit_code,
            0);
  const auto journal = bench::Journal::Open(folder / "campaign.db", bench::Database::Mode::kReadOnly);
  std::string warm_up;
  for (const bench::Event& event : journal.Events(100)) {
    if (event.code == "warm_up") warm_up = event.text;
  }
  EXPECT_EQ(
      warm_up,
      "the gear stood for a time that is not known: 1200 s of load before the measurement, not credited");
}

TEST(Resume, GoesOnInTimeAfterAPowerCutThatLeftAnOldCheckpoint) {
  const ScratchFolder scratch;
  const auto folder = scratch / "campaign";
  const pid_t process = StartProgram({"run", kSchedule, "--out", folder.string(), "--pace", "200"}, scratch);
  WaitForPhase(folder, "load_run", process);
  const auto old = bench::ReadCheckpoint(folder / "checkpoint").value();
  WaitForPhase(folder, "measurement_rotation", process);
  ::kill(process, SIGKILL);
  WaitForProgram(process, scratch);
  std::filesystem::remove(folder / "checkpoint");
  bench::CheckpointWriter(folder / "checkpoint").Write(old, old.machine_memory);
  ASSERT_EQ(RunProgram({"run", kSchedule, "--out", folder.string(), "--resume"}).exit_code, 0);
  const auto journal = bench::Journal::Open(folder / "campaign.db", bench::Database::Mode::kReadOnly);
  double now_s = 0.0;
  for (int cycle = 0; cycle <= 3; ++cycle) {
    double credited_s = 0.0;
    for (const bench::PhaseRow& row : journal.Phases(cycle)) {
      EXPECT_GE(row.started_s, now_s) << "cycle " << cycle << ", " << row.name;
      now_s = row.ended_s;
      credited_s += row.credited_load_s;
    }
    EXPECT_NEAR(credited_s, cycle == 0 ? 0.0 : 1200.0, 0.011);
  }
}

std::vector<std::string> NamesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    names.push_back(entry.path().filename());
  }
  std::ranges::sort(names);
  return names;
}

class FolderInItsPlace : public testing::TestWithParam<const char*> {};

TEST_P(FolderInItsPlace, GetsNothingAndEndsTheRunSafely) {
  const ScratchFolder scratch;
  const auto folder = scratch / "campaign";
  const auto swapped = GetParam() == std::string(".") ? folder : folder / GetParam();
  const auto away = scratch / "away";
  const pid_t process = StartProgram({"run", kSchedule, "--out", folder.string(), "--pace", "200"}, scratch);
  WaitForPhase(folder, "load_run", process);
  std::filesystem::create_directories(away / "cycles");
  std::filesystem::create_directories(away / "unfinished");
  std::ofstream(away / "unfinished/of_somebody_else.h5") << "mine";
  // The one for the other in one step: in between there would be none.
  ASSERT_EQ(::renameat2(AT_FDCWD, swapped.c_str(), AT_FDCWD, away.c_str(), RENAME_EXCHANGE), 0);
  const ProgramResult stopped = WaitForProgram(process, scratch);
  EXPECT_EQ(stopped.exit_code, 3);
  EXPECT_NE(stopped.error.find("stopped: torque is off, brakes are on, the campaign is whole"),
            std::string::npos)
      << stopped.error;
  EXPECT_NE(
      stopped.error.find(fmt::format("{}: error: another folder has come in its place (expected the folder "
                                     "that this run began with, which is now {})\n",
                                     swapped.string(), away.string())),
      std::string::npos)
      << stopped.error;
  EXPECT_EQ(NamesIn(swapped), (std::vector<std::string>{"cycles", "of_somebody_else.h5", "unfinished"}));
  std::filesystem::remove_all(swapped);
  std::filesystem::rename(away, swapped);
  EXPECT_EQ(RunProgram({"run", kSchedule, "--out", folder.string(), "--resume"}).exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(OfAll, FolderInItsPlace, testing::Values(".", "cycles", "unfinished"),
                         [](const auto& instance) {
                           const std::string name = instance.param;
                           return name == "." ? "campaign" : name;
                         });

}  // namespace
}  // namespace strainwave::campaign_resume_test
