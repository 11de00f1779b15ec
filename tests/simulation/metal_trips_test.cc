// SPDX-License-Identifier: Apache-2.0
// The trip test on a bench of metal, whose metal is the device side within the program: real protocols, real
// time. A person's hands are commands to the device side, which also says what is true of the shafts.
#include "bench/trip_test/metal_trips.h"

#include <atomic>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bench/campaign/runner_settings.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/machines/field/field_machine.h"
#include "bench/trip_test/trip_test.h"
#include "schedules/reader/read_schedule.h"
#include "tests/checkout.h"
#include "tests/simulation/field_bench.h"

namespace strainwave::bench::metal_trips_test {
namespace {

// A bench, and a person who does what is asked for by commands to the devices.
class PatientBench {
 public:
  explicit PatientBench(std::map<std::string, std::vector<std::string>> hands = {})
      : hands_(std::move(hands)), trips_(machine_, bench_, Person()) {
    EXPECT_EQ(machine_.AwaitValues([] { return false; }), "");
  }

  std::vector<TripResult> Run(const std::vector<std::string>& codes) {
    const TripSettings settings = TripSettingsOf(
        schedules::ReadSchedule(std::filesystem::path(SourceFolder()) / "schedules/quick.yaml"));
    RunnerSettings runner = RunnerSettingsOf(bench_);
    runner.limits = settings.limits;
    runner.suspend = settings.suspend;
    const std::atomic<StopRequest> request{StopRequest::kNone};
    std::vector<TripResult> results = RunTripTest(OnlyRows(TripRows(settings, bench_), codes), trips_,
                                                  settings, runner, request, [](std::size_t) {});
    EXPECT_TRUE(machine_.device_side()->StandsSafe());
    return results;
  }

  std::vector<std::string> asked;

 private:
  TripPerson Person() {
    TripPerson person;
    person.ask = [this](const std::string& what) -> std::optional<std::string> {
      asked.push_back(what);
      if (what == "make everything as it was before") {
        for (const std::string& command : mend_) machine_.device_side()->Do(command);
        mend_.clear();
        return std::nullopt;
      }
      for (const auto& [words, commands] : hands_) {
        if (what.find(words) != std::string::npos) return std::nullopt;
      }
      return "the cabinet is locked";
    };
    person.tell = [this](const std::string& what) {
      for (const auto& [words, commands] : hands_) {
        if (what.find(words) == std::string::npos) continue;
        machine_.device_side()->Do(commands.at(0));
        mend_.assign(commands.begin() + 1, commands.end());
      }
    };
    person.wait_until_ready = [] {};
    person.given_up = [] { return false; };
    return person;
  }

  std::map<std::string, std::vector<std::string>> hands_;
  std::vector<std::string> mend_;
  BenchDescription bench_{ReadBenchFile(Folder() / "bench.yaml")};
  FieldMachine machine_{bench_, 80.0, {}};
  MetalTrips trips_;
};

TEST(MetalTrips, TripOnLimitsThatAreLoweredInSlowMotion) {
  PatientBench bench;
  const std::vector<TripResult> results =
      bench.Run({"output_torque_limit", "input_speed_limit", "gear_temperature_limit", "vibration_limit",
                 "twist_limit", "temperature_suspend"});
  ASSERT_EQ(results.size(), 6U);
  for (const TripResult& result : results) {
    EXPECT_EQ(result.verdict, TripVerdict::kPassed) << result.stopped_as << ": " << result.seen;
    EXPECT_NE(result.seen.find("lowered to"), std::string::npos) << result.seen;
  }
  EXPECT_TRUE(bench.asked.empty());
}

TEST(MetalTrips, TripOnWhatAPersonDoes) {
  PatientBench bench({{"input encoder", {"stream encoders silent on", "stream encoders silent off"}},
                      {"bus cable of the load servo", {"drive 2 silent on", "drive 2 silent off"}}});
  for (const TripResult& result : bench.Run({"stale_readings"})) {
    EXPECT_EQ(result.verdict, TripVerdict::kPassed) << result.seen;
  }
  EXPECT_EQ(
      bench.asked.front(),
      "age of the readings: get ready to pull the cable of the input encoder DEV-INPUT, while the bench "
      "stands still");
  const std::vector<TripResult> silent = bench.Run({"drive_silent"});
  EXPECT_EQ(silent.at(0).verdict, TripVerdict::kSkipped);
  EXPECT_EQ(silent.at(0).seen, "the cabinet is locked");
  EXPECT_EQ(silent.at(1).verdict, TripVerdict::kPassed) << silent.at(1).seen;
}

TEST(MetalTrips, SayWhyARowIsNotTested) {
  PatientBench bench;
  const std::vector<TripResult> results = bench.Run({"brake_engaged", "quick_stop_key"});
  ASSERT_EQ(results.size(), 3U);
  for (const TripResult& result : results) EXPECT_EQ(result.verdict, TripVerdict::kSkipped);
  EXPECT_EQ(results[0].seen,
            "a brake that closes under a turning shaft is tested on the simulated bench alone");
  EXPECT_EQ(results[2].seen, "the bench has no pendant");
}

}  // namespace
}  // namespace strainwave::bench::metal_trips_test
