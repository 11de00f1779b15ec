// SPDX-License-Identifier: Apache-2.0
// How a campaign starts on a bench of metal: no channel is judged before its first value can have come, and a
// drive is left as it was found.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/campaign_runner.h"
#include "bench/campaign/runner_settings.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/controller/standstill_programs.h"
#include "bench/machines/field/field_machine.h"
#include "tests/simulation/modbus_bench.h"
#include "tests/simulation/until.h"

namespace strainwave::bench::field_start_test {
namespace {

class Listener final : public ProgressSink {
 public:
  void Update(const ProgressState&) override {}
  void Message(std::string_view severity, std::string_view text) override {
    if (severity == "alarm") alarms += std::string(text) + "\n";
  }
  void CycleStored(int, const std::vector<Result>&) override {}

  std::string alarms;
};

CampaignInputs InputsOf(const ModbusBench& bench, const std::string& stale_after) {
  std::string text = schedules::With(schedules::GoodSchedule(), "cycles: 3", "cycles: 1");
  text.erase(text.find("phases:"));
  const auto schedule = bench.folder() / "schedule.yaml";
  std::ofstream(schedule) << text << R"(phases:
  - kind: soak
    below_temperature: 60 degC
    at_most: 1 s
measurements:
  declared_temperature: 25 degC
)";
  return ReadInputs(schedule, bench.File(stale_after));
}

// A whole campaign in a folder of its own: all devices are connected, referenced, and soaked.
CampaignEnd Start(ModbusBench& bench, const std::string& stale_after, int number, std::string& alarms,
                  bool mute = false) {
  const CampaignInputs inputs = InputsOf(bench, stale_after);
  const CampaignFolder folder{bench.folder() / ("campaign_" + std::to_string(number))};
  Journal journal = CreateCampaign(folder, inputs);
  bench.set_mute(mute);
  FieldMachine machine(inputs.bench, 80.0, {});
  for (ModbusBench::Servo* const servo : {&bench.driving, &bench.load}) servo->model.TakeWritten();
  const std::atomic<StopRequest> request{StopRequest::kNone};
  Listener listener;
  CampaignRunner runner(HeldFolder(folder), inputs.schedule, inputs.bench, machine, journal, request,
                        listener);
  const CampaignEnd end = runner.Run({});
  alarms = listener.alarms;
  return end;
}

auto Enablings(ModbusBench::Servo& servo) {
  return std::ranges::count(servo.model.TakeWritten(), "control 1");
}

// Side by side, as starts wait rather than compute.
TEST(FieldStart, IsNoRaceWithTheFirstSamplesInBlocksOf1To500Milliseconds) {
  constexpr int kStarts = 50;
  constexpr int kAtATime = 5;
  constexpr double kLongest_ms = 500.0;
  std::vector<std::thread> threads;
  for (int first = 0; first < kAtATime; ++first) {
    threads.emplace_back([first] {
      for (int i = first; i < kStarts; i += kAtATime) {
        const auto block_ms =
            static_cast<std::uint32_t>(std::lround(std::pow(kLongest_ms, i / (kStarts - 1.0))));
        ModbusBench bench(block_ms);
        const BenchDescription description = ReadBenchFile(bench.File("1 s"));
        FieldMachine machine(description, 80.0, {});
        EXPECT_EQ(machine.AwaitValues([] { return false; }), "");
        RunnerSettings settings = RunnerSettingsOf(description);
        settings.limits = {60.0, 300.0, 75.0, 50.0, 0.01};
        settings.suspend = {70.0, 60.0, 1.0, 2.0, 1.0};
        const std::atomic<StopRequest> request{StopRequest::kNone};
        PhaseRunner runner(machine.Devices(), settings, request);
        ReferencingProgram program({5.0, 0.01}, 80.0, std::numeric_limits<double>::quiet_NaN());
        const PhaseOutcome outcome = runner.Run(program, [](const PhaseSnapshot&, const PhaseProgram&) {});
        EXPECT_FALSE(outcome.reason) << "blocks of " << block_ms << " ms: " << Describe(outcome.reason);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(FieldStart, CanBeRepeatedWhereTheWatchdogsEndInAFault) {
  ModbusBench bench(200);
  for (int number = 1; number <= 2; ++number) {
    std::string alarms;
    EXPECT_EQ(Start(bench, "1 s", number, alarms).kind, CampaignEnd::Kind::kCompleted) << alarms;
  }
}

TEST(FieldStart, NamesTheChannelsThatNeverComeAndEnablesNothing) {
  ModbusBench bench(5);
  std::string alarms;
  const CampaignEnd end = Start(bench, "1 s", 1, alarms, true);
  EXPECT_EQ(end.kind, CampaignEnd::Kind::kFault);
  EXPECT_TRUE(end.device_failed);
  EXPECT_EQ(
      alarms,
      "after 3 s the bench cannot start for want of: input_angle (encoders: nothing has come of it yet); "
      "output_angle (encoders: nothing has come of it yet); output_torque (encoders: nothing has come of it "
      "yet)\n");
  EXPECT_EQ(Enablings(bench.driving) + Enablings(bench.load), 0);
}

TEST(FieldStart, WaitsForAThermometerThatComesLate) {
  ModbusBench bench(5);
  bench.thermometers.Set({ModbusDeviceFault::Kind::kException, 2});
  std::string alarms;
  EXPECT_EQ(Start(bench, "1 s", 1, alarms).kind, CampaignEnd::Kind::kCompleted) << alarms;
}

TEST(FieldStart, RefusesBlocksThatCannotBeFresh) {
  ModbusBench bench(500);
  std::string alarms;
  const CampaignEnd end = Start(bench, "100 ms", 1, alarms);
  EXPECT_EQ(end.kind, CampaignEnd::Kind::kFault);
  EXPECT_TRUE(end.device_failed);
  EXPECT_TRUE(
      alarms.starts_with("after 3 s the bench cannot start for want of: encoders sends its samples in blocks "
                         "of 500 ms (500 at 1000 "
                         "Hz), but stale_after is 100 ms: its values cannot stay fresh (expected shorter "
                         "blocks, or stale_after of "
                         "at least 510 ms in the bench file)"))
      << alarms;
  EXPECT_EQ(Enablings(bench.driving) + Enablings(bench.load), 0);
}

// What the encoders were counted to is told after their first block, and holds from the next on.
TEST(FieldStart, WaitsForTheFirstBlockThatIsCountedOnFromThePowerCut) {
  constexpr std::int64_t kTurned = std::int64_t{1} << 32;
  ModbusBench bench(500);
  FieldMachine machine(ReadBenchFile(bench.File("1 s")), 80.0, {});
  const auto never = [] { return false; };
  ASSERT_EQ(machine.AwaitValues(never), "");
  std::vector<std::int64_t> turns(2);
  const auto memory = machine.Memory();
  ASSERT_EQ(memory.size(), std::as_writable_bytes(std::span(turns)).size());
  std::ranges::copy(memory, std::as_writable_bytes(std::span(turns)).begin());
  for (std::int64_t& turn : turns) turn += kTurned;
  machine.RestoreMemory(std::as_bytes(std::span(turns)));
  ASSERT_EQ(machine.AwaitValues(never), "");
  EXPECT_NEAR(machine.Devices().sampler.Read().input_angle_rad, RadFromDeg(kTurned / 1000.0),
              RadFromDeg(0.1));
}

TEST(FieldStart, LeavesAFaultThatItOnlyLooksAtAndShowsIt) {
  ModbusBench bench(5);
  bench.driving.fault_code = 17.0;
  bench.driving.model.Fault();
  const FieldMachine machine(ReadBenchFile(bench.File("1 s")), 80.0, {}, FieldMachine::Use::kLook);
  const auto is_shown = [&] {
    return std::ranges::any_of(machine.States(), [](const FieldMachine::DeviceState& state) {
      return state.device == "driving servo" && state.state == "in fault, code 17 (11h)" && !state.good;
    });
  };
  Until(is_shown);
  EXPECT_EQ(std::ranges::count(bench.driving.model.TakeWritten(), "control 4"), 0);
}

TEST(FieldStart, ResetsAFaultThatWasThereBefore) {
  ModbusBench bench(5);
  bench.load.model.Fault();
  std::string alarms;
  EXPECT_EQ(Start(bench, "1 s", 1, alarms).kind, CampaignEnd::Kind::kCompleted) << alarms;
}

}  // namespace
}  // namespace strainwave::bench::field_start_test
