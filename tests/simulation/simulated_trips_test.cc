// SPDX-License-Identifier: Apache-2.0
// The trip test on the simulated bench: every interlock passes, and one that sees or does nothing is found.
#include "bench/trip_test/simulated_trips.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bench/campaign/runner_settings.h"
#include "bench/configuration/embedded_bench.h"
#include "bench/trip_test/trip_test.h"

namespace strainwave::bench::simulated_trips_test {
namespace {

// A sampler that changes what is read before anybody sees it.
class ChangedSampler final : public Sampler {
 public:
  using Change = std::function<void(Readings&)>;
  ChangedSampler(Sampler& sampler, Change change) : sampler_(sampler), change_(std::move(change)) {}
  Readings Read() noexcept override {
    Readings readings = sampler_.Read();
    change_(readings);
    return readings;
  }
  void StartVibration(double sample_rate_hz) override { sampler_.StartVibration(sample_rate_hz); }
  void StopVibration() override { sampler_.StopVibration(); }
  void DrainVibration(VibrationBlock& block) override { sampler_.DrainVibration(block); }

 private:
  Sampler& sampler_;
  Change change_;
};

// A drive that does not obey an order to stop while it is enabled.
class UnstoppedServo final : public ServoDrive {
 public:
  explicit UnstoppedServo(ServoDrive& drive) : drive_(drive) {}
  void Enable(DriveMode mode) noexcept override { drive_.Enable(mode); }
  void Disable() noexcept override { drive_.Disable(); }
  void QuickStop() noexcept override {
    if (Actual().power != protocols::PowerState::kOperationEnabled) drive_.QuickStop();
  }
  void ResetFault() noexcept override { drive_.ResetFault(); }
  void SetBrake(bool engaged) noexcept override { drive_.SetBrake(engaged); }
  void CommandSpeed(double value_rad_per_s) noexcept override { drive_.CommandSpeed(value_rad_per_s); }
  void CommandPosition(double value_rad) noexcept override { drive_.CommandPosition(value_rad); }
  void CommandTorque(double value_Nm) noexcept override { drive_.CommandTorque(value_Nm); }
  DriveActual Actual() const noexcept override { return drive_.Actual(); }

 private:
  ServoDrive& drive_;
};

// A simulated bench with something hidden wrong between it and the controller.
class FlawedTrips final : public SimulatedTrips {
 public:
  explicit FlawedTrips(ChangedSampler::Change change, bool unstopped = false)
      : SimulatedTrips(EmbeddedBench(), TripSettingsOf(EmbeddedBench())),
        change_(std::move(change)),
        unstopped_(unstopped) {}
  BenchDevices Devices() override {
    BenchDevices devices = SimulatedTrips::Devices();
    sampler_ = std::make_unique<ChangedSampler>(devices.sampler, change_);
    load_ = std::make_unique<UnstoppedServo>(devices.load);
    return {devices.driving, unstopped_ ? *load_ : devices.load, *sampler_, devices.clock};
  }

 private:
  ChangedSampler::Change change_;
  bool unstopped_;
  std::unique_ptr<ChangedSampler> sampler_;
  std::unique_ptr<UnstoppedServo> load_;
};

std::vector<TripRow> Rows(const std::vector<std::string>& codes = {}) {
  const BenchDescription bench = EmbeddedBench();
  return OnlyRows(TripRows(TripSettingsOf(bench), bench), codes);
}

std::vector<TripResult> RunRows(
    TripBench& bench, const std::vector<TripRow>& rows, const std::atomic<StopRequest>& request,
    const std::function<void(std::size_t)>& on_row = [](std::size_t) {}) {
  const TripSettings settings = TripSettingsOf(EmbeddedBench());
  RunnerSettings runner = RunnerSettingsOf(EmbeddedBench());
  runner.limits = settings.limits;
  runner.suspend = settings.suspend;
  return RunTripTest(rows, bench, settings, runner, request, on_row);
}

const std::atomic<StopRequest> kNoRequest{StopRequest::kNone};

TEST(SimulatedTrips, PassEveryRowThatTheBenchWatches) {
  SimulatedTrips bench(EmbeddedBench(), TripSettingsOf(EmbeddedBench()));
  const std::vector<TripRow> rows = Rows();
  const std::vector<TripResult> results = RunRows(bench, rows, kNoRequest);
  ASSERT_EQ(results.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].cause == StopCause::kQuickStopKey) {
      EXPECT_EQ(results[i].verdict, TripVerdict::kSkipped);
      EXPECT_EQ(results[i].seen, "the bench has no pendant");
      continue;
    }
    EXPECT_EQ(results[i].verdict, TripVerdict::kPassed) << rows[i].signal << ": " << results[i].seen;
    EXPECT_EQ(results[i].stopped_as, Code(rows[i].cause));
  }
}

// The shafts turned, so that it means something that they stand.
TEST(SimulatedTrips, TakeTimeForTheShaftsToStand) {
  SimulatedTrips bench(EmbeddedBench(), TripSettingsOf(EmbeddedBench()));
  const std::vector<TripResult> results = RunRows(bench, Rows({"output_torque_limit"}), kNoRequest);
  EXPECT_GT(results.at(0).safe_after_s.value(), results.at(0).tripped_after_s.value() + 0.02);
}

TEST(SimulatedTrips, TripTheKeyOfABenchThatHasOne) {
  SimulatedTrips bench(EmbeddedBench(), TripSettingsOf(EmbeddedBench()));
  std::vector<TripRow> rows = Rows({"quick_stop_key", "drive_fault"});
  std::ranges::find(rows, StopCause::kQuickStopKey, &TripRow::cause)->unwatched.clear();
  for (const TripResult& result : RunRows(bench, rows, kNoRequest)) {
    EXPECT_EQ(result.verdict, TripVerdict::kPassed) << result.seen;
  }
}

TEST(FlawedTrips, ShowATransducerThatIsNotWired) {
  FlawedTrips bench([](Readings& readings) { readings.output_torque_Nm = -8.5; });
  const std::vector<TripResult> results = RunRows(bench, Rows({"output_torque_limit"}), kNoRequest);
  EXPECT_EQ(results.at(0).verdict, TripVerdict::kFailed);
  EXPECT_EQ(results.at(0).seen, "not tripped within 1040 ms");
  EXPECT_TRUE(bench.StandsSafe());
}

TEST(FlawedTrips, ShowAGoodFlagThatIsAlwaysSet) {
  FlawedTrips bench([](Readings& readings) { readings.bad_channels = 0; });
  for (const TripResult& result :
       RunRows(bench, Rows({"implausible_reading", "sensor_suspend"}), kNoRequest)) {
    EXPECT_EQ(result.verdict, TripVerdict::kFailed) << result.seen;
  }
  EXPECT_TRUE(bench.StandsSafe());
}

TEST(FlawedTrips, ShowALimitThatAnotherStandsInFor) {
  // Above 72 degC the thermometer shows 72: the run is suspended, and the limit is never reached.
  FlawedTrips bench([](Readings& readings) {
    readings.gear_temperature_degC = std::min(readings.gear_temperature_degC, 72.0);
  });
  const std::vector<TripResult> results = RunRows(bench, Rows({"gear_temperature_limit"}), kNoRequest);
  EXPECT_EQ(results.at(0).verdict, TripVerdict::kFailed);
  EXPECT_EQ(results.at(0).stopped_as, "temperature_suspend");
}

TEST(FlawedTrips, ShowADriveThatDoesNotObeyTheOrderToStop) {
  FlawedTrips bench([](Readings&) {}, true);
  const std::vector<TripResult> results = RunRows(bench, Rows({"output_torque_limit"}), kNoRequest);
  EXPECT_EQ(results.at(0).verdict, TripVerdict::kFailed);
  EXPECT_EQ(results.at(0).seen, "tripped after 10 ms, not safe within 3040 ms");
}

TEST(SimulatedTrips, EndWhereAPersonStopsThem) {
  SimulatedTrips bench(EmbeddedBench(), TripSettingsOf(EmbeddedBench()));
  std::atomic<StopRequest> request{StopRequest::kNone};
  const std::vector<TripResult> results = RunRows(
      bench, Rows({"output_torque_limit", "input_speed_limit", "twist_limit"}), request, [&](std::size_t i) {
        if (i == 1) request = StopRequest::kQuickStop;
      });
  ASSERT_EQ(results.size(), 3U);
  EXPECT_EQ(results[0].verdict, TripVerdict::kPassed);
  EXPECT_EQ(results[1].verdict, TripVerdict::kSkipped);
  EXPECT_EQ(results[1].seen, "stopped on request");
  EXPECT_EQ(results[2].seen, "the test was stopped before");
  EXPECT_TRUE(bench.StandsSafe());
}

}  // namespace
}  // namespace strainwave::bench::simulated_trips_test
