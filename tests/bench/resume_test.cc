// SPDX-License-Identifier: Apache-2.0
// A campaign cut between two of the writes that belong together.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <regex>
#include <vector>

#include <gtest/gtest.h>

#include "bench/campaign/campaign.h"
#include "bench/campaign/sample_totals.h"
#include "bench/errors/bench_error.h"
#include "bench/utc.h"
#include "daq/checkpoint_file.h"
#include "tests/checkout.h"

namespace strainwave::bench::resume_test {
namespace {

class CutCampaign : public testing::Test {
 protected:
  CutCampaign() {
    for (const int cycle : {0, 1}) journal_.BeginCycle(cycle, 0.0);
  }
  ~CutCampaign() override { std::filesystem::remove_all(folder_.root); }

  std::int64_t BeginPhase(int step, int cycle = 0) {
    PhaseRow row;
    row.cycle = cycle;
    row.step = step;
    row.attempt = 1;
    row.name = "lock";
    row.kind = "hysteresis";
    return journal_.BeginPhase(row);
  }
  void Leave(const Checkpoint& checkpoint) {
    CheckpointWriter(folder_.Checkpoint()).Write(checkpoint, std::vector<std::byte>(5, std::byte{7}));
  }
  CampaignInputs Given(const std::string& from, const std::string& to) const {
    const auto file = folder_.root / "given.yaml";
    std::string text = inputs_.schedule_text;
    std::ofstream(file) << text.replace(text.find(from), from.size(), to);
    return ReadInputs(file, std::nullopt);
  }
  std::string Refusal(const std::function<void()>& asked) const {
    try {
      asked();
    } catch (const BenchError& error) {
      return std::string(error.what()).substr(folder_.root.string().size());
    }
    return "none";
  }
  std::optional<ResumePoint> Resume(bool accept_pause = true) {
    return PrepareResume(folder_, inputs_, journal_, {.by = "a person", .accept_pause = accept_pause});
  }

  CampaignFolder folder_{std::filesystem::temp_directory_path() /
                         ("strainwave_resume_test_" + std::to_string(::getpid()))};
  CampaignInputs inputs_ = ReadInputs(SourceFolder() + "/tests/simulation/small.yaml", std::nullopt);
  Journal journal_ = [this] {
    std::filesystem::remove_all(folder_.root);
    return CreateCampaign(folder_, inputs_);
  }();
};

TEST_F(CutCampaign, TakesAMeasurementAgainThatWasUnderWay) {
  BeginPhase(0);
  Leave({.step = 0, .time_s = 30.0});
  ASSERT_TRUE(Resume().has_value());
  EXPECT_EQ(journal_.Phases(0).at(0).outcome, "interrupted");
  EXPECT_EQ(journal_.Holes().at(0).phase, "lock");
}

TEST_F(CutCampaign, TakesNothingAgainWhereOnlyTheEndIsMissingInTheJournal) {
  BeginPhase(0);
  Leave({.step = 0, .finished = true, .credited_load_s = 12.0, .time_s = 30.0});
  ASSERT_TRUE(Resume().has_value());
  const PhaseRow row = journal_.Phases(0).at(0);
  EXPECT_EQ(row.outcome, "complete");
  EXPECT_EQ(row.ended_s, 30.0);
  EXPECT_EQ(row.credited_load_s, 12.0);
  EXPECT_EQ(journal_.Holes().at(0).phase, "");
}

TEST_F(CutCampaign, DoesNotTakeTheEndOfAnotherPhaseForItsOwn) {
  journal_.EndPhase(BeginPhase(0), 30.0, "complete", 0.0);
  BeginPhase(1);
  Leave({.step = 0, .finished = true, .time_s = 30.0});
  ASSERT_TRUE(Resume().has_value());
  EXPECT_EQ(journal_.Phases(0).at(1).outcome, "interrupted");
}

TEST_F(CutCampaign, GoesOnFromACheckpointWhosePhaseIsNotOnRecord) {
  Leave({.step = 0, .time_s = 0.5});
  const auto point = Resume();
  ASSERT_TRUE(point.has_value());
  ASSERT_TRUE(point->checkpoint.has_value());
  EXPECT_EQ(point->checkpoint->time_s, 0.5);
  EXPECT_EQ(point->checkpoint->machine_memory.size(), 5U);
}

TEST_F(CutCampaign, GoesOnOnABenchOfMetalWhichHasNoMemory) {
  BeginPhase(0);
  CheckpointWriter(folder_.Checkpoint()).Write({.step = 0, .time_s = 30.0}, {});
  const auto point = Resume();
  ASSERT_TRUE(point.has_value());
  ASSERT_TRUE(point->checkpoint.has_value());
  EXPECT_EQ(point->checkpoint->time_s, 30.0);
}

TEST_F(CutCampaign, BeginsAnewWhereNoPhaseHadBegun) {
  journal_.AddEvent({2.5, UtcNow(), 0, "referencing", "alarm", "", ""});
  const auto point = Resume();
  ASSERT_TRUE(point.has_value());
  EXPECT_FALSE(point->checkpoint.has_value());
  EXPECT_EQ(point->time_s, 2.5);
}

TEST_F(CutCampaign, CountsSamplesFromTheTotalsThatAreKept) {
  const auto complete = [&](int cycle, double received, double lost) {
    if (cycle > 1) journal_.BeginCycle(cycle, 0.0);
    journal_.AddResults(cycle, 0,
                        {{"samples_received_front", received, 0.0, ""},
                         {"samples_lost_front", lost, 0.0, ""},
                         {"samples_lost_in_files_front", 1000.0, 0.0, ""}});
    journal_.EndCycle(cycle, 1.0, "complete", "");
  };
  complete(0, 10.0, 1.0);
  complete(1, 20.0, 2.0);
  EXPECT_EQ(SamplesOf(journal_).at("front").received, 30.0);
  KeepSampleTotals(journal_);
  // The rows below the totals are not read any more.
  journal_.ClearResults(0);
  complete(2, 40.0, std::nan(""));
  for (int kept = 0; kept < 3; ++kept) {
    const auto counts = SamplesOf(journal_);
    ASSERT_EQ(counts.size(), 1u);
    EXPECT_EQ(counts.at("front").received, 70.0);
    EXPECT_EQ(counts.at("front").lost, 3.0);
    KeepSampleTotals(journal_);
  }
}

// As a power cut leaves it on a disk that did not keep what it had said was safe.
TEST_F(CutCampaign, GoesOnInTimeFromTheJournalWhereTheCheckpointIsOlder) {
  Leave({.step = 0, .time_s = 1.0});
  journal_.EndPhase(BeginPhase(0), 1571.0, "complete", 0.0);
  BeginPhase(1);
  journal_.AddEvent({1580.0, UtcNow(), 0, "lock", "info", "bench", ""});
  const auto point = Resume();
  ASSERT_TRUE(point.has_value());
  EXPECT_EQ(point->time_s, 1580.0);
  EXPECT_EQ(journal_.Phases(0).at(1).ended_s, 1580.0);
  EXPECT_EQ(journal_.Holes().at(0).time_s, 1580.0);
  EXPECT_EQ(journal_.LatestTime_s(), 1580.0);
  // Its phase was complete before: what the checkpoint says of it counts no more.
  EXPECT_EQ(journal_.Phases(0).at(0).outcome, "complete");
  EXPECT_EQ(point->checkpoint->machine_memory.size(), 5U);
}

TEST_F(CutCampaign, MeasuresThePauseByTheClockThatNobodySets) {
  Moment written = Now();
  written.utc_ms += 18'000'000;
  Leave({.step = 0, .written = written});
  const auto point = Resume(false);
  ASSERT_TRUE(point.has_value());
  EXPECT_GE(point->pause.length_s, 0.0);
  EXPECT_EQ(
      journal_.Holes().at(0).clock,
      "clock of this machine since its start; UTC was set by -18000.0 s meanwhile; bench time stood still");
}

TEST_F(CutCampaign, IsNotResumedAfterAPauseThatIsNotKnownUnlessAccepted) {
  const std::int64_t ahead_ms = 1'000'000'000;
  Leave({.step = 0, .written = {UtcMilliseconds() + ahead_ms, 0, Now().boot ^ 1}});
  try {
    Resume(false);
    FAIL() << "resumed";
  } catch (const BenchError& error) {
    const std::string text = std::regex_replace(error.what(), std::regex("says -[0-9.]+ s"), "says -N s");
    EXPECT_EQ(text,
              folder_.root.string() +
                  ": error: how long the campaign has stood is not known: UTC of this machine was set "
                  "back, it says -N s (expected --accept-pause, to go on as after the longest pause and "
                  "have it noted)");
  }
  EXPECT_TRUE(journal_.Holes().empty());
  const auto point = Resume();
  ASSERT_TRUE(point.has_value());
  EXPECT_FALSE(point->pause.length_s.has_value());
  EXPECT_TRUE(journal_.Holes().at(0).clock.starts_with("length not known: UTC of this machine was set back"));
  EXPECT_TRUE(journal_.Events(9).at(1).text.starts_with(
      "resumed after a pause of unknown length (UTC of this machine was set back"))
      << journal_.Events(9).at(1).text;
}

TEST_F(CutCampaign, HasEveryBeatOfARealSecondOnTheDisk) {
  CheckpointWriter writer(folder_.Checkpoint());
  std::chrono::steady_clock::time_point now{std::chrono::hours(1)};
  for (int beat = 0; beat < 5; ++beat) {
    EXPECT_TRUE(writer.Write({.step = beat}, {}, now)) << beat;
    now += std::chrono::microseconds(999'900);  // the loop wakes up a little early
  }
  // At more than twice the pace of the world, not every one.
  EXPECT_FALSE(writer.Write({}, {}, now - std::chrono::microseconds(600'000)));
}

TEST_F(CutCampaign, HasABeatOfAFastSimulationEvery5Milliseconds) {
  CheckpointWriter writer(folder_.Checkpoint());
  const std::chrono::steady_clock::time_point now{std::chrono::hours(1)};
  EXPECT_TRUE(writer.IsDue(now));
  writer.Write({}, {}, now);
  EXPECT_FALSE(writer.IsDue(now + std::chrono::microseconds(4'999)));
  EXPECT_TRUE(writer.IsDue(now + std::chrono::milliseconds(5)));
}

TEST_F(CutCampaign, IsExtendedByCyclesAloneAndSaysSoInItsJournal) {
  Leave({.time_s = 30.0});
  const CampaignInputs longer = Given("cycles: 3", "cycles: 12");
  const auto refusal = [&](const CampaignInputs& given) {
    return Refusal(
        [&] { PrepareResume(folder_, given, journal_, {.by = "a person", .accept_pause = true}); });
  };
  EXPECT_EQ(
      refusal(longer),
      ": error: the schedule has changed since the start (expected the frozen schedule.yaml; the "
      "difference is:\n  line 34: -cycles: 3\n  line 34: +cycles: 12\n  or --extend, to go on with more "
      "cycles)");
  EXPECT_EQ(ExtendCampaign(folder_, longer, journal_), "extended from 3 to 12 cycles");
  EXPECT_EQ(journal_.Events(1).at(0).code, "extended");
  EXPECT_EQ(journal_.Events(1).at(0).text, "extended from 3 to 12 cycles");
  EXPECT_EQ(ReadFrozenInputs(folder_, journal_).schedule.cycles, 12);
  EXPECT_EQ(refusal(longer), "none");
  EXPECT_EQ(refusal(inputs_),
            ": error: the schedule has changed since the start (expected the frozen schedule.yaml; the "
            "difference is:\n  line 34: -cycles: 12\n  line 34: +cycles: 3\n  )");
  EXPECT_NO_THROW(OpenCampaign(folder_, Database::Mode::kReadOnly)) << "the frozen files are what they were";
}

TEST_F(CutCampaign, IsNotExtendedByAnythingElse) {
  const auto refusal = [&](const CampaignInputs& given) {
    return Refusal([&] { ExtendCampaign(folder_, given, journal_); });
  };
  EXPECT_EQ(refusal(inputs_),
            ": error: the schedule has 3 cycles, the campaign 3 (expected more, to extend the campaign)");
  EXPECT_EQ(refusal(Given("cycles: 3", "cycles: 2")),
            ": error: the schedule has 2 cycles, the campaign 3 (expected more, to extend the campaign)");
  EXPECT_EQ(
      refusal(Given("output_torque: 40 Nm", "output_torque: 41 Nm"))
          .find(": error: the schedule has changed since the start (expected the frozen schedule.yaml; the "
                "difference is:\n  line "),
      0U);
  EXPECT_EQ(ReadFrozenInputs(folder_, journal_).schedule.cycles, 3);
}

TEST_F(CutCampaign, RefusesAPhaseOnRecordWithoutACheckpoint) {
  // Without a preparation the first phase is of cycle 1.
  BeginPhase(0, 1);
  try {
    Resume();
    FAIL() << "resumed";
  } catch (const BenchError& error) {
    EXPECT_EQ(error.what(), folder_.Checkpoint().string() +
                                ": error: the checkpoint is missing or damaged (expected the file that the "
                                "campaign has written)");
  }
}

TEST_F(CutCampaign, HasItsInputsWithoutTheProfilesOfItsDrives) {
  const CampaignFolder folder{folder_.root / "field"};
  const std::filesystem::path tests = SourceFolder() + "/tests/simulation";
  const Journal journal =
      CreateCampaign(folder, ReadInputs(tests / "small.yaml", tests / "field/bench.yaml"));
  EXPECT_EQ(ReadFrozenInputs(folder, journal).bench.driving_servo.drive.profile.filename(), "drive.yaml");
}

TEST(BeginningOfACampaign, LeavesNothingWhereItFails) {
  const std::filesystem::path top =
      std::filesystem::temp_directory_path() / ("strainwave_beginning_test_" + std::to_string(::getpid()));
  const std::filesystem::path tests = SourceFolder() + "/tests/simulation";
  const CampaignInputs good = ReadInputs(tests / "small.yaml", tests / "field/bench.yaml");
  CampaignInputs bad = good;
  bad.bench.devices.front().file = tests / "no_such_file.yaml";
  const auto failure = [](const CampaignFolder& folder, const CampaignInputs& inputs) {
    try {
      const CampaignLock lock(folder);
      CreateCampaign(folder, inputs);
      return std::string("none");
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
  };
  const std::string missing = (tests / "no_such_file.yaml").string() + ": No such file or directory";
  // A folder of its own; and one that a person has made, with a file that the campaign would have
  // overwritten.
  EXPECT_EQ(failure({top / "new"}, bad), missing);
  EXPECT_FALSE(std::filesystem::exists(top / "new"));
  std::filesystem::create_directories(top / "own");
  std::ofstream(top / "own/schedule.yaml") << good.schedule_text;
  EXPECT_EQ(failure({top / "own"}, bad), missing);
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(top / "own"))
    left.push_back(entry.path().filename());
  EXPECT_EQ(left, std::vector<std::string>{"schedule.yaml"});
  // Then it simply begins.
  for (const char* const folder : {"new", "own"}) {
    EXPECT_EQ(failure({top / folder}, good), "none");
    EXPECT_TRUE(std::filesystem::exists(top / folder / "campaign.db"));
    EXPECT_TRUE(std::filesystem::exists(top / folder / "lock"));
  }
  std::filesystem::remove_all(top);
}

TEST(LockOfACampaign, LeavesAFolderAloneThatHasComeInItsPlace) {
  const std::filesystem::path top =
      std::filesystem::temp_directory_path() / ("strainwave_lock_test_" + std::to_string(::getpid()));
  const CampaignFolder folder{top / "campaign"};
  for (const bool has_lock : {false, true}) {
    {
      const CampaignLock lock(folder);
      std::filesystem::rename(folder.root, top / "away");
      std::filesystem::create_directory(folder.root);
      if (has_lock) std::ofstream(folder.Lock()) << "of somebody else";
    }
    EXPECT_TRUE(std::filesystem::exists(folder.root));
    EXPECT_EQ(std::filesystem::exists(folder.Lock()), has_lock);
    std::filesystem::remove_all(top);
  }
}

// What a start that was killed before it had its journal has left: above all times to stop of another bench.
TEST(BeginningOfACampaign, TakesNothingFromAnEarlierOne) {
  const CampaignFolder folder{std::filesystem::temp_directory_path() /
                              ("strainwave_earlier_test_" + std::to_string(::getpid()))};
  std::filesystem::create_directories(folder.Cycles());
  std::ofstream(folder.root / "bench.commissioned.yaml") << "commissioned: 1\ndrives: []\n";
  for (const char* const name : {"campaign.db.new", "campaign.db.new-wal"}) {
    std::ofstream(folder.root / name) << "half a database";
  }
  const Journal journal =
      CreateCampaign(folder, ReadInputs(SourceFolder() + "/tests/simulation/small.yaml", std::nullopt));
  EXPECT_EQ(journal.LastCompleteCycle(), -1);
  EXPECT_FALSE(std::filesystem::exists(folder.root / "bench.commissioned.yaml"));
  std::filesystem::remove_all(folder.root);
}

// The header of version 1, byte by byte: four integers, two numbers, an integer, a number; then the memory.
TEST_F(CutCampaign, ReadsTheCheckpointOfAnEarlierVersion) {
  std::vector<std::byte> payload(48 + 3, std::byte{9});
  const std::int32_t integers[4] = {1, 2, 3, 4};
  const double credited_and_time_s[2] = {60.0, 70.0};
  const std::int64_t utc_ms = 80;
  const double offset_rad = 0.25;
  std::memcpy(payload.data(), integers, 16);
  std::memcpy(payload.data() + 16, credited_and_time_s, 16);
  std::memcpy(payload.data() + 32, &utc_ms, 8);
  std::memcpy(payload.data() + 40, &offset_rad, 8);
  daq::CheckpointFile(folder_.Checkpoint()).Write(payload);
  const auto read = ReadCheckpoint(folder_.Checkpoint());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->cycle, 2);
  EXPECT_EQ(read->repeat, 4);
  EXPECT_FALSE(read->finished);
  EXPECT_EQ(read->credited_load_s, 60.0);
  EXPECT_EQ(read->encoder_offset_rad, 0.25);
  EXPECT_EQ(read->machine_memory, std::vector<std::byte>(3, std::byte{9}));
}

// The fields up to version 3 in their places, without the clock of the boot.
TEST_F(CutCampaign, ReadsACheckpointThatDoesNotSayOfWhichBootItIs) {
  std::vector<std::byte> payload(80 + 3, std::byte{9});
  const std::int32_t integers[4] = {3, 2, 3, 4};
  const std::int64_t utc_ms = 80;
  const std::int64_t finished_campaign_phase_event[4] = {1, 77, 5, 6};
  std::memcpy(payload.data(), integers, 16);
  std::memcpy(payload.data() + 32, &utc_ms, 8);
  std::memcpy(payload.data() + 48, finished_campaign_phase_event, 32);
  daq::CheckpointFile(folder_.Checkpoint()).Write(payload);
  const auto read = ReadCheckpoint(folder_.Checkpoint());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->campaign, 77U);
  EXPECT_EQ(read->journal_end.event, 6);
  EXPECT_EQ(read->written.utc_ms, 80);
  EXPECT_EQ(read->written.boot, 0U);
  EXPECT_EQ(read->machine_memory, std::vector<std::byte>(3, std::byte{9}));
}

}  // namespace
}  // namespace strainwave::bench::resume_test
