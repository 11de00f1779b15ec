// SPDX-License-Identifier: Apache-2.0
// The kernel's own IIO device, made of a HID sensor (sensor_peer.h), read by ours: on this machine and behind
// Debian's iiod. Skipped without /dev/uhid; in a virtual machine: tests/vm/run.sh
// build/tests/iio_device_test.
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>

#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/sources/iio_devices.h"
#include "daq/acquisition/sources/iio_source.h"
#include "tests/bench/real_time.h"
#include "tests/simulation/program.h"
#include "tests/vm/sensor_peer.h"

namespace strainwave::daq::acquisition::iio_device_test {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kInterval{10};

// Debian's server of IIO devices, on its own port.
class Iiod {
 public:
  // Where it lies: build_image.sh keeps one, of which tests/vm/kernel_devices.cmake tells.
  static std::string Program() {
    const char* const given = std::getenv("STRAINWAVE_IIOD");
    return given != nullptr ? given : "/usr/sbin/iiod";
  }

  Iiod() {
    std::string program = Program();
    char* arguments[] = {program.data(), nullptr};
    started_ = ::posix_spawn(&process_, program.c_str(), nullptr, nullptr, arguments, environ) == 0;
  }
  Iiod(const Iiod&) = delete;
  Iiod& operator=(const Iiod&) = delete;
  ~Iiod() {
    if (!started_) return;
    ::kill(process_, SIGKILL);  // it would try to reach Avahi for a minute
    ::waitpid(process_, nullptr, 0);
  }

 private:
  pid_t process_{};
  bool started_{};
};

class IioDevice : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (::access("/dev/uhid", R_OK | W_OK) != 0)
      GTEST_SKIP() << "skipped: this kernel has no /dev/uhid for us";
    if (GetParam() != "local:" && !std::filesystem::exists(Iiod::Program()))
      GTEST_SKIP() << "skipped: there is no " << Iiod::Program() << " (Debian's package iiod)";
    Plug();
    // A server that is not up yet refuses, and the device has its attributes only after a moment.
    ASSERT_TRUE(bench::Until([&] { return Starts(); })) << why_not_;
  }
  void Plug() {
    peer_.emplace(kInterval);
    ASSERT_TRUE(peer_->made());
    ASSERT_TRUE(bench::Until(KernelHasOne));
    if (GetParam() != "local:") server_.emplace();
  }
  // The number of a device that is gone may still be taken by who has it open.
  static bool KernelHasOne() {
    return std::ranges::any_of(
        std::filesystem::directory_iterator("/sys/bus/iio/devices"),
        [](const auto& entry) { return entry.path().filename().string().starts_with("iio:device"); });
  }
  void Unplug() {
    peer_.reset();
    server_.reset();  // knows the devices of its start alone
  }
  bool Starts() {
    try {
      source_.Start();
    } catch (const std::system_error& error) {
      why_not_ = error.what();
      return false;
    }
    ledger_.emplace(CounterRules{}, source_.description().rate_hz);
    return true;
  }

  // Blocks from here on, each of which goes on from the one before but for what `ledger_` books.
  void ExpectBlocks(int count) {
    for (int i = 0; i < count; ++i) {
      NextResult result{};
      while ((result = source_.Next(block_, 20s)) == NextResult::kNothingYet) {
      }
      ASSERT_EQ(result, NextResult::kBlock) << source_.trouble();
      ledger_->Admit(block_);
      for (std::uint32_t s = 0; s < block_.header.samples; ++s) {
        const double k = block_.Value(s, 0);
        if (s > 0) {
          ASSERT_EQ(k, *last_ + 1);
        } else if (last_) {
          ASSERT_GT(k, *last_);
        }
        ASSERT_EQ(block_.Value(s, 1), -k);
        ASSERT_EQ(block_.Value(s, 2), 1000);
        last_ = k;
      }
    }
  }

  std::optional<SensorPeer> peer_;
  std::optional<Iiod> server_;
  IioSource source_{
      {.uri = GetParam(), .device = "accel_3d", .samples_a_block = 25, .between_attempts = 100ms}};
  std::optional<GapLedger> ledger_;
  SampleBlock block_{100};
  std::optional<double> last_;
  std::string why_not_;
};

TEST_P(IioDevice, GivesItsCountsWithTheDriversScaleAndLosesNone) {
  const SourceDescription& description = source_.description();
  ASSERT_EQ(description.channels.size(), 3U);
  EXPECT_EQ(description.rate_hz, 100);
  EXPECT_EQ(description.channels[0].name, "accel_x");
  EXPECT_EQ(description.channels[0].unit, "m/s^2");
  // Thousandths of g.
  EXPECT_NEAR(description.channels[2].calibration.Apply(1000), 9.80665, 1e-5);
  EXPECT_TRUE(source_.has_time_stamps());
  ExpectBlocks(20);
  EXPECT_EQ(ledger_->totals().received, 500U);
  EXPECT_EQ(ledger_->totals().lost, 0U);
}

TEST_P(IioDevice, IsAmongThoseThatAreFound) {
  std::vector<std::string> troubles;
  const std::vector<IioDeviceInfo> found = FindIioDevices(troubles);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].uri, "local:");
  EXPECT_EQ(found[0].device, "accel_3d");
  EXPECT_EQ(found[0].channels, (std::vector<std::string>{"accel_x", "accel_y", "accel_z"}));
}

TEST_P(IioDevice, IsListedByTheProgram) {
  const ProgramResult result = RunProgram({"devices"});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.out.find("local:/accel_3d"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("accel_x, accel_y, accel_z"), std::string::npos) << result.out;
}

TEST_P(IioDevice, ShowsWhatTheSensorDidNotSend) {
  ExpectBlocks(4);
  peer_->Mute(true);
  const std::int32_t enough = peer_->sent() + 200;
  ASSERT_TRUE(bench::Until([&] { return peer_->sent() >= enough; }));
  peer_->Mute(false);
  const double before = *last_;
  std::uint64_t seen = ledger_->totals().received;
  ExpectBlocks(4);
  seen = ledger_->totals().received - seen;
  // All that were sent meanwhile came or are booked: within one, of the moment at which it fell silent.
  EXPECT_NEAR(static_cast<double>(seen + ledger_->totals().lost), *last_ - before, 1.0);
  EXPECT_EQ(ledger_->totals().gaps, 1U);
}

TEST_P(IioDevice, DoesNotMindWhenTheDateIsSet) {
  if (::getenv("STRAINWAVE_VM") == nullptr)
    GTEST_SKIP() << "skipped: sets the date, which tests/vm/run.sh alone may do";
  ExpectBlocks(4);
  for (const std::time_t step : {3, -7, 3600}) {
    timespec now{};
    ASSERT_EQ(::clock_gettime(CLOCK_REALTIME, &now), 0);
    now.tv_sec += step;
    ASSERT_EQ(::clock_settime(CLOCK_REALTIME, &now), 0);
    ExpectBlocks(4);
  }
  EXPECT_EQ(ledger_->totals().received, 400U);
  EXPECT_EQ(ledger_->totals().lost, 0U);
  EXPECT_EQ(ledger_->totals().resets, 0U);
}

TEST_P(IioDevice, ComesBackWhenItIsPluggedInAgain) {
  ExpectBlocks(4);
  Unplug();
  NextResult result{};
  while ((result = source_.Next(block_, 20s)) != NextResult::kFailed) {
    ASSERT_EQ(result, NextResult::kBlock);
  }
  ASSERT_EQ(result, NextResult::kFailed);
  EXPECT_EQ(source_.trouble().find("iio:" + GetParam() + "/accel_3d: "), 0U) << source_.trouble();
  Plug();
  last_.reset();
  ExpectBlocks(4);
  EXPECT_EQ(ledger_->totals().gaps, 1U);
  EXPECT_GT(ledger_->totals().lost, 0U);
}

INSTANTIATE_TEST_SUITE_P(Contexts, IioDevice, testing::Values("local:", "ip:127.0.0.1"),
                         [](const auto& context) { return context.param == "local:" ? "Local" : "Iiod"; });

}  // namespace
}  // namespace strainwave::daq::acquisition::iio_device_test
