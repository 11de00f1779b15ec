// SPDX-License-Identifier: Apache-2.0
// What is done on a bus besides driving: looking who is there, and measuring how drives stop by themselves.
#include <gtest/gtest.h>

#include "bench/controller/measure_stop_time.h"
#include "bench/devices/canopen/scan_nodes.h"
#include "protocols/canopen/wire_bytes.h"
#include "tests/bench/canopen/in_process_drives.h"

namespace strainwave::bench::bus_tools_test {
namespace {

using protocols::canopen::DeviceTypeWords;
using protocols::canopen::FoundNode;
using protocols::canopen::FrameOf;
using protocols::canopen::IdentityText;
using protocols::canopen::NmtState;
using protocols::canopen::NodeScan;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

// Where somebody waits, the devices go on, and their master if it is alive.
class RunningClock final : public BenchClock {
 public:
  explicit RunningClock(InProcessDrives& bench) : bench_(bench) {}
  nanoseconds Now() const noexcept override { return bench_.clock.now; }
  void SleepUntil(nanoseconds time) noexcept override {
    bench_.Run(time - bench_.clock.now, [] {});
  }
  std::uint64_t Overruns() const noexcept override { return 0; }

 private:
  InProcessDrives& bench_;
};

TEST(NodeScan, FindsEveryNodeAndWritesNothing) {
  InProcessDrives bench;
  bench.bench_alive = false;
  RunningClock clock(bench);
  clock.SleepUntil(milliseconds(200));  // the drives boot up
  bench.sent_to_drives.clear();
  NodeScan scan(milliseconds(300));
  std::string note;
  const std::vector<FoundNode> found = ScanNodes(bench.buses.end(0), clock, scan, note);
  EXPECT_EQ(note, "");
  ASSERT_EQ(found.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found[i].node_id, i + 1);
    EXPECT_EQ(DeviceTypeWords(found[i].device_type.value_or(0)), "servo drive (CiA 402)");
    // As strainwave_drive.eds has it.
    EXPECT_EQ(IdentityText(found[i]),
              "vendor 00005357h, product 00000402h, revision 00010000h, serial 00000001h");
  }
  // The first question to each of 127, and four more to the two that answer; uploads alone.
  std::size_t questions = 0;
  for (const auto& frame : bench.sent_to_drives) {
    if (frame.id < 0x600 || frame.id > 0x67F) continue;
    ++questions;
    EXPECT_EQ(frame.data[0], 0x40);
  }
  EXPECT_EQ(questions, 127U + 2U * 4U);
}

TEST(NodeScan, IsOverAsSoonAsThoseThatWereAskedHaveSaidAll) {
  InProcessDrives bench;
  bench.bench_alive = false;
  RunningClock clock(bench);
  clock.SleepUntil(milliseconds(200));
  NodeScan scan(seconds(10), {2});
  std::string note;
  const std::vector<FoundNode> found = ScanNodes(bench.buses.end(0), clock, scan, note);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].node_id, 2);
  EXPECT_LT(clock.Now(), seconds(1));
}

TEST(NodeScan, FindsANodeThatHasNothingToSayAndOneThatOnlyBeats) {
  NodeScan scan(milliseconds(300));
  scan.Start(seconds(1));
  while (scan.NextFrame(seconds(1))) continue;
  for (int object = 0; object < 5; ++object) {
    // "There is no such object", to whatever was asked.
    const std::uint8_t index = object == 0 ? 0x00 : 0x18;
    scan.OnFrame(FrameOf(0x585, {0x80, index, 0x10, static_cast<std::uint8_t>(object), 0, 0, 2, 6}),
                 seconds(1));
    (void)scan.NextFrame(seconds(1));
  }
  scan.OnFrame(FrameOf(0x709, {0x05}), seconds(1));
  EXPECT_FALSE(scan.IsDone(seconds(1) + milliseconds(299)));
  EXPECT_TRUE(scan.IsDone(seconds(1) + milliseconds(300)));
  const std::vector<FoundNode> found = scan.Nodes();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].node_id, 5);
  EXPECT_EQ(IdentityText(found[0]), "");
  EXPECT_EQ(found[1].node_id, 9);
  EXPECT_EQ(found[1].nmt_state, NmtState::kOperational);
  EXPECT_FALSE(scan.has_other_master());
  scan.OnFrame(FrameOf(0x080, {}), seconds(1));
  EXPECT_TRUE(scan.has_other_master());
}

TEST(NodeScan, SaysThatNobodyHearsIt) {
  InProcessCanBus alone({.ends = 2, .transmit_frames = 10});
  alone.SetBusOff(1, true);
  struct : BenchClock {
    nanoseconds Now() const noexcept override { return now; }
    void SleepUntil(nanoseconds time) noexcept override { bus->Exchange(now = time); }
    std::uint64_t Overruns() const noexcept override { return 0; }
    InProcessCanBus* bus{};
    nanoseconds now{};
  } clock;
  clock.bus = &alone;
  NodeScan scan(milliseconds(100));
  std::string note;
  EXPECT_TRUE(ScanNodes(alone.end(0), clock, scan, note).empty());
  EXPECT_EQ(
      note,
      "does not get rid of its frames: nobody else on the bus hears them (check that the devices are on, "
      "bitrate, wiring and both terminating resistors)");
  EXPECT_LT(clock.now, milliseconds(200)) << "a dead bus is not waited for";
}

TEST(DeviceTypes, AreToldInWords) {
  EXPECT_EQ(DeviceTypeWords(0), "device without a profile");
  EXPECT_EQ(DeviceTypeWords(0x00040192), "stepper drive (CiA 402)");
  EXPECT_EQ(DeviceTypeWords(0x000F0191), "inputs and outputs (CiA 401)");
  EXPECT_EQ(DeviceTypeWords(0x00000196), "encoder (CiA 406)");
  EXPECT_EQ(DeviceTypeWords(0x00000FFF), "device (CiA 4095)");
}

// The angles of the two motors themselves.
class MotorSampler final : public Sampler {
 public:
  explicit MotorSampler(InProcessDrives& bench) : bench_(bench) {}
  Readings Read() noexcept override {
    Readings readings;
    readings.time = bench_.clock.now;
    readings.SetSampleTimes(readings.time);
    readings.input_angle_rad = bench_.motors[0].reading.position_inc / 65536.0 * kTwoPi;
    readings.input_speed_rad_per_s = bench_.motors[0].reading.speed_inc_per_s / 65536.0 * kTwoPi;
    readings.output_angle_rad = bench_.motors[1].reading.position_inc / 65536.0 * kTwoPi;
    return readings;
  }
  void StartVibration(double) override {}
  void StopVibration() override {}
  void DrainVibration(VibrationBlock&) override {}

 private:
  InProcessDrives& bench_;
};

class StopTimeOfDrives : public testing::Test {
 protected:
  StopTimeOfDrives() {
    bench_.Commission();
    parameters_.input_speed_rad_per_s = RadPerSFromRpm(300.0);
    parameters_.input_acceleration_rad_per_s2 = 100.0;
    parameters_.period_s = 0.004;
    parameters_.stale_after_s = 0.03;
    parameters_.limits = {10.0, 100.0, 80.0, 10.0, 1.0};
    parameters_.standstill_rad_per_s = {0.5, 0.5};
  }
  StopTimes Measure(const std::function<void()>& go_silent) {
    return MeasureStopTimes({bench_.driving(), bench_.load(), sampler_, clock_}, parameters_, go_silent,
                            request_);
  }

  InProcessDrives bench_;
  RunningClock clock_{bench_};
  MotorSampler sampler_{bench_};
  StopTimeParameters parameters_;
  std::atomic<StopRequest> request_{StopRequest::kNone};
};

TEST_F(StopTimeOfDrives, IsThatOfTheirOwnSupervision) {
  nanoseconds silent_since{};
  const StopTimes times = Measure([&] {
    silent_since = clock_.Now();
    bench_.driving().GoSilent();
    bench_.load().GoSilent();
    EXPECT_GT(bench_.motors[0].reading.speed_inc_per_s, 0.85 * 5.0 * 65536.0);
  });
  EXPECT_FALSE(times.ended_before) << Describe(times.ended_before);
  ASSERT_GT(silent_since.count(), 0);
  for (const StopTime& drive : times.drives) {
    ASSERT_TRUE(drive.left_enabled_after && drive.stood_after);
    // 14xxh:05 of the profile is 100 ms, the shortest of what watches; on top at most the last SYNC before,
    // and what a period sees late.
    EXPECT_GE(*drive.left_enabled_after, milliseconds(96));
    EXPECT_LE(*drive.left_enabled_after, milliseconds(116));
  }
  // From 300 rpm by 800 turns/s² that is 6 ms more; the load stands all the time.
  EXPECT_GT(*times.drives[0].stood_after, milliseconds(96));
  EXPECT_LE(*times.drives[0].stood_after, milliseconds(130));
  EXPECT_LE(*times.drives[1].stood_after, milliseconds(8));
  bench_.Run(seconds(3));
  EXPECT_TRUE(bench_.motors[0].command.brake_engaged);
  bench_.BringUp(bench_.driving(), DriveMode::kSpeed);
  EXPECT_NE(bench_.driving().Actual().power, protocols::PowerState::kOperationEnabled)
      << "not before a set-up";
  bench_.driving().Commission();
  bench_.load().Commission();
  bench_.Run(seconds(5));
  bench_.BringUp(bench_.driving(), DriveMode::kSpeed);
  EXPECT_EQ(bench_.driving().Actual().power, protocols::PowerState::kOperationEnabled);
}

TEST_F(StopTimeOfDrives, IsNoneOfDrivesThatGoOn) {
  parameters_.most = seconds(1);
  const StopTimes times = Measure([] {});  // the master lives on: the loop is what is missing
  EXPECT_FALSE(times.drives[0].left_enabled_after || times.drives[0].stood_after);
  bench_.Run(seconds(1));
  EXPECT_EQ(bench_.motors[0].reading.speed_inc_per_s, 0.0) << "stopped all the same";
  EXPECT_TRUE(bench_.motors[0].command.brake_engaged);
}

TEST_F(StopTimeOfDrives, IsNotMeasuredBeyondALimit) {
  parameters_.limits.input_speed_rad_per_s = 10.0;
  bool silent = false;
  const StopTimes times = Measure([&] { silent = true; });
  EXPECT_EQ(times.ended_before.cause, StopCause::kInputSpeedLimit);
  EXPECT_FALSE(silent);
  bench_.Run(seconds(1));
  EXPECT_TRUE(bench_.motors[0].command.brake_engaged);
}

}  // namespace
}  // namespace strainwave::bench::bus_tools_test
