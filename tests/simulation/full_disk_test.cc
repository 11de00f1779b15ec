// SPDX-License-Identifier: Apache-2.0
// A disk that is full, will be full, or cannot be written.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/mount.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "bench/campaign/checkpoint.h"
#include "bench/campaign/journal.h"
#include "tests/simulation/campaign_program.h"
#include "tests/simulation/program.h"
#include "tests/simulation/until.h"

namespace strainwave::full_disk_test {
namespace {

/// A file system of its own, small or read-only; not mounted where this machine does not let the test mount
/// one.
class MountedFolder {
 public:
  explicit MountedFolder(const std::string& options) {
    mounted_ = ::mount("tmpfs", folder_.path().c_str(), "tmpfs", 0, options.c_str()) == 0;
  }
  MountedFolder(const MountedFolder&) = delete;
  MountedFolder& operator=(const MountedFolder&) = delete;
  ~MountedFolder() {
    if (mounted_) ::umount(folder_.path().c_str());
  }
  bool mounted() const { return mounted_; }
  void Remount(unsigned long flags, const std::string& options) {
    ::mount("tmpfs", folder_.path().c_str(), "tmpfs", MS_REMOUNT | flags, options.c_str());
  }
  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }

 private:
  ScratchFolder folder_;
  bool mounted_{};
};

TEST(FullDisk, IsSeenBeforeTheCycleThatWouldFillIt) {
  MountedFolder disk("size=9m");
  if (!disk.mounted()) GTEST_SKIP() << "skipped, because this machine lets no test mount a file system";
  const std::string folder = disk / "campaign";
  const ProgramResult ended = RunProgram({"run", kSchedule, "--out", folder});
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_NE(ended.error.find("the disk is nearly full: "), std::string::npos) << ended.error;
  EXPECT_NE(ended.error.find("stopped: torque is off, brakes are on; when the cause is mended, go on with: "),
            std::string::npos)
      << ended.error;
  {
    const auto journal = bench::Journal::Open(folder + "/campaign.db", bench::Database::Mode::kReadOnly);
    const auto alarms = journal.Alarms(0.0);
    ASSERT_FALSE(alarms.empty());
    EXPECT_EQ(alarms.back().code, "disk_full");
    EXPECT_TRUE(journal.Phases(journal.LastCompleteCycle() + 1).empty()) << "no phase was begun";
  }
  disk.Remount(0, "size=50m");
  const ProgramResult resumed = RunProgram({"run", kSchedule, "--out", folder, "--resume"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.error;
}

TEST(FullDisk, ThatWillNotLastIsAnAlarmUntilItDoes) {
  MountedFolder disk("size=20m");
  if (!disk.mounted()) GTEST_SKIP() << "skipped, because this machine lets no test mount a file system";
  const std::string folder = disk / "campaign";
  std::ofstream(disk / "of somebody else") << std::string(8 << 20, 'x');
  const std::string schedule = disk / "schedule.yaml";
  std::string text = WholeFile(kSchedule);
  std::ofstream(schedule) << text.replace(text.find("cycles: 3"), 9, "cycles: 300");
  const ProgramResult ended = RunProgram({"run", schedule, "--out", folder});
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_NE(ended.error.find(" are free, and the raw data of the cycles to come may take "),
            std::string::npos)
      << ended.error;
  const auto journal = bench::Journal::Open(folder + "/campaign.db", bench::Database::Mode::kReadOnly);
  const auto alarms = journal.Alarms(0.0);
  ASSERT_EQ(alarms.size(), 2U);
  EXPECT_EQ(alarms[0].code, "disk_fills");
  EXPECT_NE(alarms[0].text.find(" h of bench time: "), std::string::npos) << alarms[0].text;
  EXPECT_EQ(alarms[1].code, "disk_full");
  EXPECT_GT(journal.LastCompleteCycle(), 0);
  const ProgramResult status = RunProgram({"status", folder});
  EXPECT_NE(status.out.find("  LITTLE ROOM  "), std::string::npos) << status.out;
}

// A run on a disk of its own that somebody else fills in the middle of a cycle.
class DiskThatOthersFill : public testing::Test {
 protected:
  // A campaign in whose load run the disk is left with no more than that, at once.
  ProgramResult RunUntilOthersLeave(std::uintmax_t bytes) {
    const ScratchFolder said;
    const pid_t process = StartProgram({"run", kSchedule, "--out", folder_, "--pace", "50"}, said);
    bench::Until([&] { return HasRows(); });
    Leave(bytes);
    return WaitForProgram(process, said);
  }
  void Leave(std::uintmax_t bytes) {
    const int other = ::open((disk_ / "of somebody else").c_str(), O_WRONLY | O_CREAT, 0600);
    // Again where the campaign has written meanwhile.
    bench::Until([&] {
      const auto space = std::filesystem::space(disk_ / "");
      return ::posix_fallocate(other, 0, static_cast<off_t>(space.available - bytes)) == 0;
    });
    ::close(other);
  }
  // A campaign that has to warm up before it goes on: it stopped between a load run and what measures it, and
  // how long ago is not known.
  void StopWarm() {
    const ScratchFolder said;
    const pid_t process = StartProgram({"run", kSchedule, "--out", folder_, "--pace", "200"}, said);
    WaitForPhase(folder_, "measurement_rotation", process);
    ::kill(process, SIGTERM);
    ASSERT_EQ(WaitForProgram(process, said).exit_code, 130);
    auto left = bench::ReadCheckpoint(folder_ + "/checkpoint").value();
    left.written.boot ^= 1;
    bench::CheckpointWriter(folder_ + "/checkpoint").Write(left, left.machine_memory);
  }
  bool HasEvent(const std::string& code) const {
    const auto journal = bench::Journal::Open(folder_ + "/campaign.db", bench::Database::Mode::kReadOnly);
    const auto events = journal.Events(100);
    return std::any_of(events.begin(), events.end(), [&](const auto& event) { return event.code == code; });
  }
  void ExpectEndedInWords(const ProgramResult& ended, const std::string& phase) const {
    EXPECT_EQ(ended.exit_code, 3);
    EXPECT_NE(ended.error.find(" are free, and what the cycle under way has recorded may take "),
              std::string::npos)
        << ended.error;
    const auto journal = bench::Journal::Open(folder_ + "/campaign.db", bench::Database::Mode::kReadOnly);
    const auto alarms = journal.Alarms(0.0);
    ASSERT_EQ(alarms.size(), 1U);
    EXPECT_EQ(alarms[0].code, "disk_full");
    EXPECT_EQ(alarms[0].phase, phase);
  }
  // The first rows of a load run are there after ten seconds of the world's, when half of it is to come.
  bool HasRows() const {
    const std::filesystem::path unfinished = folder_ + "/unfinished";
    if (!std::filesystem::exists(unfinished)) return false;
    const std::filesystem::directory_iterator files(unfinished);
    return std::any_of(begin(files), end(files),
                       [](const auto& file) { return file.path().extension() == ".rows"; });
  }
  void GoOnWithRoom() {
    EXPECT_EQ(RunProgram({"status", folder_}).exit_code, 0);
    disk_.Remount(0, "size=90m");
    const ProgramResult resumed =
        RunProgram({"run", kSchedule, "--out", folder_, "--resume", "--accept-pause"});
    EXPECT_EQ(resumed.exit_code, 0) << resumed.error;
    const auto journal = bench::Journal::Open(folder_ + "/campaign.db", bench::Database::Mode::kReadOnly);
    EXPECT_EQ(journal.LastCompleteCycle(), 3);
  }

  MountedFolder disk_{"size=40m"};
  const std::string folder_ = disk_ / "campaign";
};

TEST_F(DiskThatOthersFill, EndsTheCycleWhileThatCanBeWrittenDown) {
  if (!disk_.mounted()) GTEST_SKIP() << "skipped, because this machine lets no test mount a file system";
  const ProgramResult ended = RunUntilOthersLeave(6 << 20);
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_NE(ended.error.find(" are free, and what the cycle under way has recorded may take "),
            std::string::npos)
      << ended.error;
  EXPECT_NE(ended.error.find("stopped: torque is off, brakes are on; when the cause is mended, go on with: "),
            std::string::npos)
      << ended.error;
  {
    const auto journal = bench::Journal::Open(folder_ + "/campaign.db", bench::Database::Mode::kReadOnly);
    const auto alarms = journal.Alarms(0.0);
    ASSERT_EQ(alarms.size(), 1U);
    EXPECT_EQ(alarms[0].code, "disk_full");
    const auto phases = journal.Phases(journal.LastCompleteCycle() + 1);
    ASSERT_FALSE(phases.empty());
    EXPECT_EQ(phases.back().outcome, "disk_full");
    EXPECT_GT(phases.back().credited_load_s, 60.0) << "what was served counts";
    EXPECT_LT(phases.back().credited_load_s, 1200.0) << "it was ended before its time";
  }
  GoOnWithRoom();
}

TEST_F(DiskThatOthersFill, IsSeenInReferencesBeforeTheGearIsWarmedUp) {
  if (!disk_.mounted()) GTEST_SKIP() << "skipped, because this machine lets no test mount a file system";
  StopWarm();
  Leave(6 << 20);
  ExpectEndedInWords(RunProgram({"run", kSchedule, "--out", folder_, "--resume", "--accept-pause"}),
                     "referencing");
  EXPECT_FALSE(HasEvent("warm_up"));
  GoOnWithRoom();
}

TEST_F(DiskThatOthersFill, EndsAWarmUp) {
  if (!disk_.mounted()) GTEST_SKIP() << "skipped, because this machine lets no test mount a file system";
  StopWarm();
  const ScratchFolder said;
  const pid_t process =
      StartProgram({"run", kSchedule, "--out", folder_, "--resume", "--accept-pause", "--pace", "100"}, said);
  bench::Until([&] { return HasEvent("warm_up"); });
  Leave(6 << 20);
  ExpectEndedInWords(WaitForProgram(process, said), "warm_up");
  GoOnWithRoom();
}

// Nobody can foresee that.
TEST_F(DiskThatOthersFill, StopsSafelyWhereNothingIsLeftAtAll) {
  if (!disk_.mounted()) GTEST_SKIP() << "skipped, because this machine lets no test mount a file system";
  const ProgramResult full = RunUntilOthersLeave(0);
  EXPECT_EQ(full.exit_code, 3);
  EXPECT_NE(full.error.find("stopped: torque is off, brakes are on"), std::string::npos) << full.error;
  GoOnWithRoom();
}

TEST(ReadOnlyFolder, IsRefusedBeforeAnythingMoves) {
  MountedFolder disk("size=1m");
  if (!disk.mounted()) GTEST_SKIP() << "skipped, because this machine lets no test mount a file system";
  disk.Remount(MS_RDONLY, "size=1m");
  const ProgramResult refused = RunProgram({"run", kSchedule, "--out", disk / "campaign"});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_EQ(refused.error, "error: filesystem error: cannot create directories: Read-only file system [" +
                               (disk / "campaign") + "]\n");
}

}  // namespace
}  // namespace strainwave::full_disk_test
