// SPDX-License-Identifier: Apache-2.0
// The program as a user runs it: a whole small campaign, then everything that can be wrong with its folder.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/mount.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "bench/campaign/checkpoint.h"
#include "bench/campaign/journal.h"
#include "tests/simulation/campaign_program.h"
#include "tests/simulation/program.h"

namespace strainwave::campaign_command_test {
namespace {

/// One campaign for all tests that only look; the ones that damage it take a copy.
class Campaign : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    result_ = RunProgram({"run", kSchedule, "--out", Path(), "--truth", (*folder_ / "truth.csv").string()});
  }
  static void TearDownTestSuite() { delete folder_; }
  // Each test says itself that there was nothing to look at.
  void SetUp() override {
    ASSERT_EQ(result_.exit_code, 0) << "the campaign that these tests look at: " << result_.error;
  }

  static std::string Path() { return (*folder_ / "campaign").string(); }
  static std::filesystem::path Copy(const ScratchFolder& scratch) {
    std::filesystem::copy(Path(), scratch / "copy", std::filesystem::copy_options::recursive);
    return scratch / "copy";
  }

  static ScratchFolder* folder_;
  static ProgramResult result_;
};
ScratchFolder* Campaign::folder_ = nullptr;
ProgramResult Campaign::result_;

TEST_F(Campaign, EndsWellWithATableAndPictures) {
  EXPECT_NE(result_.out.find("K1 Nm/rad"), std::string::npos);
  EXPECT_NE(result_.out.find("campaign: " + Path()), std::string::npos);
  for (const char* name : {"_cycles_1_and_3_hysteresis_lock_0deg", "_cycles_1_and_3_transmission_error",
                           "_cycles_1_to_3_trends"}) {
    const std::string picture = Path() + "/pictures/campaign" + name;
    EXPECT_NE(result_.out.find(picture + ".svg (and .png)\n"), std::string::npos);
    for (const char* ending : {".svg", ".png"})
      EXPECT_GT(std::filesystem::file_size(picture + ending), 1000u);
  }
}

TEST_F(Campaign, HasTheFilesOfTheContract) {  // docs/contract.md#campaign-folder
  for (const char* file :
       {"schedule.yaml", "bench.yaml", "campaign.db", "cycles/000000.h5", "cycles/000003.h5"}) {
    EXPECT_TRUE(std::filesystem::exists(Path() + "/" + file)) << file;
  }
  EXPECT_EQ(WholeFile(Path() + "/schedule.yaml"), WholeFile(kSchedule));
  EXPECT_TRUE(std::filesystem::is_empty(Path() + "/unfinished"));
}

TEST_F(Campaign, RecomputesToTheSameBits) {
  const ProgramResult again = RunProgram({"recompute", Path(), "--json"});
  ASSERT_EQ(again.exit_code, 0) << again.error;
  const auto report = nlohmann::json::parse(again.out);
  EXPECT_EQ(report["cycles"].size(), 3u);
  EXPECT_EQ(report["cycles_recomputed"], 4);  // the preparation among them
  EXPECT_EQ(report["cycles_equal_to_stored"], 4);
}

// The truth is the simulation's own parameters, which no part of the measurement sees.
TEST_F(Campaign, MeasuresWhatIsTrue) {
  const auto report = nlohmann::json::parse(RunProgram({"recompute", Path(), "--json"}).out);
  std::ifstream truth(*folder_ / "truth.csv");
  std::string line;
  std::getline(truth, line);
  ASSERT_TRUE(line.starts_with("cycle,k1_Nm_per_rad,k2_Nm_per_rad,k3_Nm_per_rad,e_avg_arcmin,e_max_arcmin"));
  std::size_t cycles = 0;
  while (std::getline(truth, line)) {
    std::istringstream row(line);
    std::vector<double> values;
    for (std::string cell; std::getline(row, cell, ',');) values.push_back(std::stod(cell));
    const auto cycle = static_cast<std::size_t>(values[0]);
    if (cycle == 0) continue;
    ++cycles;
    const auto& measured = report["cycles"].at(cycle - 1);
    EXPECT_NEAR(measured["k1_Nm_per_rad"].get<double>() / values[1], 1.0, 0.01);
    EXPECT_NEAR(measured["k2_Nm_per_rad"].get<double>() / values[2], 1.0, 0.01);
    EXPECT_NEAR(measured["k3_Nm_per_rad"].get<double>() / values[3], 1.0, 0.01);
    EXPECT_NEAR(measured["e_max_arcmin"].get<double>() / values[5], 1.0, 0.03);
  }
  EXPECT_EQ(cycles, 3u);
}

TEST_F(Campaign, TellsItsStatus) {
  const auto status = nlohmann::json::parse(RunProgram({"status", Path(), "--json"}).out);
  EXPECT_EQ(status["running"], false);
  EXPECT_EQ(status["cycles_complete"], 3);
  EXPECT_EQ(status["alarms"].size(), 0u);
  EXPECT_EQ(status["eta_s"], 0.0);
  EXPECT_TRUE(status["pace"].is_null()) << "nothing runs";
  EXPECT_GT(status["life_share"], 0.0);
}

TEST_F(Campaign, IsNotBegunTwiceInOneFolder) {
  const ProgramResult again = RunProgram({"run", kSchedule, "--out", Path()});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_EQ(again.error,
            Path() +
                ": error: the folder holds a campaign already (expected a new folder, or --resume to go "
                "on with it)\n");
}

TEST_F(Campaign, IsNotResumedWithAnotherSchedule) {
  const ScratchFolder scratch;
  std::string text = WholeFile(kSchedule);
  text.replace(text.find("cycles: 3"), 9, "cycles: 4");
  const std::string changed = (scratch / "changed.yaml").string();
  std::ofstream(changed) << text;
  const ProgramResult resumed = RunProgram({"run", changed, "--out", Path(), "--resume"});
  EXPECT_EQ(resumed.exit_code, 2);
  EXPECT_EQ(resumed.error,
            Path() +
                ": error: the schedule has changed since the start (expected the frozen schedule.yaml; "
                "the difference is:\n  line 34: -cycles: 3\n  line 34: +cycles: 4\n  or --extend, to go on "
                "with more "
                "cycles)\n");
}

TEST_F(Campaign, SaysWhichCycleFileIsMissing) {
  const ScratchFolder scratch;
  const auto copy = Copy(scratch);
  std::filesystem::remove(copy / "cycles/000002.h5");
  const ProgramResult again = RunProgram({"recompute", copy.string()});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_EQ(again.error,
            (copy / "cycles/000002.h5").string() +
                ": error: the file of cycle 2 is missing (expected the raw records that the journal says "
                "were stored)\n");
}

TEST_F(Campaign, SaysWhichCycleFileIsCut) {
  const ScratchFolder scratch;
  const auto copy = Copy(scratch);
  const auto file = copy / "cycles/000002.h5";
  const auto size = std::filesystem::file_size(file);
  std::filesystem::resize_file(file, 100000);
  const ProgramResult again = RunProgram({"recompute", copy.string()});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_EQ(again.error, file.string() + ": error: not a complete HDF5 file (truncated: 100000 of " +
                             std::to_string(size) + " bytes) (expected the file as it was written)\n");
}

TEST_F(Campaign, IsNotReadFromAForeignDatabase) {
  const ScratchFolder scratch;
  const auto copy = Copy(scratch);
  std::filesystem::remove(copy / "campaign.db");
  {
    const bench::Database foreign(copy / "campaign.db", bench::Database::Mode::kCreate);
    foreign.Execute("CREATE TABLE birds(name TEXT)");
  }
  const ProgramResult status = RunProgram({"status", copy.string()});
  EXPECT_EQ(status.exit_code, 3);
  EXPECT_EQ(status.error,
            (copy / "campaign.db").string() +
                ": error: not a campaign journal (expected a database that strainwave run has made)\n");
}

TEST_F(Campaign, IsNotReadFromAFolderThatIsNone) {
  const ScratchFolder scratch;
  const ProgramResult status = RunProgram({"status", scratch.path().string()});
  EXPECT_EQ(status.exit_code, 2);
  EXPECT_EQ(status.error, scratch.path().string() +
                              ": error: not a campaign (expected a folder with schedule.yaml, bench.yaml and "
                              "campaign.db)\n");
}

TEST_F(Campaign, IsNotResumedWhereThereIsNone) {
  const ScratchFolder scratch;
  const ProgramResult resumed =
      RunProgram({"run", kSchedule, "--out", (scratch / "none").string(), "--resume"});
  EXPECT_EQ(resumed.exit_code, 2);
  EXPECT_EQ(resumed.error,
            (scratch / "none").string() +
                ": error: there is no campaign to resume (expected a folder with campaign.db; leave "
                "--resume away to start one)\n");
}

TEST_F(Campaign, SaysWhichCycleIsNotWhatIsComputedFromItsRecords) {
  const ScratchFolder scratch;
  const auto copy = Copy(scratch);
  {
    auto journal = bench::Journal::Open(copy / "campaign.db", bench::Database::Mode::kReadWrite);
    journal.AddResults(2, 0, {{"k2_Nm_per_rad", 12345.0, 1.0, ""}});
  }
  const ProgramResult again = RunProgram({"recompute", copy.string(), "--json"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_EQ(nlohmann::json::parse(again.out)["cycles_differing"], std::vector<int>{2});
  // Asked for by another method, a difference is no fault.
  EXPECT_EQ(RunProgram({"recompute", copy.string(), "--method", "loading"}).exit_code, 0);
}

TEST_F(Campaign, IsNotReadWithTheFileOfAnotherCycle) {
  const ScratchFolder scratch;
  const auto copy = Copy(scratch);
  std::filesystem::copy_file(copy / "cycles/000001.h5", copy / "cycles/000002.h5",
                             std::filesystem::copy_options::overwrite_existing);
  const ProgramResult again = RunProgram({"recompute", copy.string()});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_EQ(again.error, (copy / "cycles/000002.h5").string() +
                             ": error: holds the records of cycle 1 (expected those of cycle 2)\n");
}

/// What every reader says of a campaign, but for the room on the disk, which changes meanwhile, and that
/// features could not be kept (read_only_medium_test.py).
std::vector<std::string> Read(const std::string& campaign) {
  std::vector<std::string> said;
  for (const char* command : {"status", "recompute", "features"}) {
    const ProgramResult read = RunProgram({command, campaign, "--json"});
    EXPECT_EQ(read.exit_code, 0) << command << ": " << read.error;
    nlohmann::json json = nlohmann::json::parse(read.out);
    json.erase("disk");
    if (std::string_view(command) == "features") json.erase("warnings");
    said.push_back(json.dump());
  }
  return said;
}

TEST_F(Campaign, ThatNobodyRunsHasNobodyToAskForAStop) {
  const ProgramResult stopped = RunProgram({"stop", Path(), "quick-stop"});
  EXPECT_EQ(stopped.exit_code, 0) << stopped.error;
  EXPECT_EQ(stopped.out,
            Path() +
                ": nobody runs this campaign: there is nobody to ask for a stop (after a kill or a power "
                "cut the drives stop by their own supervision: look at the bench before anybody goes "
                "near)\n");
}

TEST_F(Campaign, IsReadOnAMediumThatCannotBeWritten) {
  const ScratchFolder scratch;
  const std::string campaign = Copy(scratch).string();
  const auto writable = Read(campaign);
  std::filesystem::remove(campaign + "/features.h5");
  if (::mount(campaign.c_str(), campaign.c_str(), "", MS_BIND, nullptr) != 0) {
    GTEST_SKIP() << "skipped, because this machine lets no test mount a file system";
  }
  ::mount("", campaign.c_str(), "", MS_BIND | MS_REMOUNT | MS_RDONLY, nullptr);
  const auto read_only = Read(campaign);
  ::umount(campaign.c_str());
  EXPECT_EQ(read_only, writable);
}

ProgramResult InterruptAtCycleOne(int signal, const ScratchFolder& scratch, const std::string& pace) {
  const auto folder = scratch / "campaign";
  const pid_t process = StartProgram({"run", kSchedule, "--out", folder.string(), "--pace", pace}, scratch);
  WaitForPhase(folder, "", process);
  ::kill(process, signal);
  return WaitForProgram(process, scratch);
}

struct Verb {
  const char* name;
  int signal;
  const char* code;
};

class FourWaysToEnd : public testing::TestWithParam<Verb> {};

TEST_P(FourWaysToEnd, AreSafeResumableAndTellable) {
  const ScratchFolder scratch;
  const ProgramResult stopped = InterruptAtCycleOne(GetParam().signal, scratch, "200");
  EXPECT_EQ(stopped.exit_code, 130) << stopped.error;
  const auto folder = scratch / "campaign";
  {
    const auto journal = bench::Journal::Open(folder / "campaign.db", bench::Database::Mode::kReadOnly);
    bool noted = false;
    for (const bench::Event& event : journal.Events(10)) noted = noted || event.code == GetParam().code;
    EXPECT_TRUE(noted);
    for (const bench::PhaseRow& row : journal.Phases(1)) EXPECT_NE(row.outcome, "running");
  }
  const ProgramResult resumed = RunProgram({"run", kSchedule, "--out", folder.string(), "--resume"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.error;
  const auto journal = bench::Journal::Open(folder / "campaign.db", bench::Database::Mode::kReadOnly);
  EXPECT_EQ(journal.LastCompleteCycle(), 3);
  for (int cycle = 1; cycle <= 3; ++cycle) {
    double credited_s = 0.0;
    for (const bench::PhaseRow& row : journal.Phases(cycle)) credited_s += row.credited_load_s;
    EXPECT_NEAR(credited_s, 1200.0, 1.0);
  }
  EXPECT_EQ(journal.Holes().size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(BySignal, FourWaysToEnd,
                         testing::Values(Verb{"QuickStop", SIGINT, "quick_stop"},
                                         Verb{"Shutdown", SIGTERM, "shutdown"},
                                         Verb{"Pause", SIGUSR1, "pause"},
                                         Verb{"FinishCycle", SIGUSR2, "finish_cycle"}),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace strainwave::campaign_command_test
