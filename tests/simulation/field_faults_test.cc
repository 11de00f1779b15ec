// SPDX-License-Identifier: Apache-2.0
// Faults of devices during phases, over the real protocols and in real time: the shafts are safe within the
// stated time, and the reason is named. The whole matrix, for the README: STRAINWAVE_FAULT_MATRIX=1.
#include <atomic>
#include <chrono>
#include <iostream>
#include <thread>

#include <gtest/gtest.h>

#include "bench/campaign/campaign_error.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/controller/make_program.h"
#include "bench/devices/field/field_machine.h"
#include "tests/simulation/bench_fixture.h"
#include "tests/simulation/device_faults.h"

namespace strainwave::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

// The slowest way to notice: a thermometer is believed for 2 s, then borne for 2 s (bad_sensor).
constexpr seconds kStated{5};
// While the input is locked, nobody can tell that its encoder repeats its last value, and nothing comes of
// it.
constexpr seconds kUntilTheInputTurns{30};

seconds Stated(const Fault& fault, std::size_t phase) {
  const bool locked = std::string_view(kPhases[phase]) == "hysteresis";
  return locked && fault.cause == StopCause::kInputAngleApart ? kUntilTheInputTurns : kStated;
}

// In the order of kPhases.
std::vector<schedules::PhaseParameters> Phases() {
  schedules::MeasurementRotation rotation = TestRotation();
  rotation.turns = 20;  // long enough for a fault to meet it
  rotation.vibration_rate_hz = 12800.0;
  schedules::HysteresisTest hysteresis = TestHysteresis();
  hysteresis.torque_rate_Nm_per_s = 20.0;
  return {TestLoadRun(60.0), rotation, TestSweep(), hysteresis};
}

struct Observed {
  PhaseOutcome outcome;
  std::string words;
  nanoseconds noticed_after{};  // by the bench
  nanoseconds safe_after{};     // in truth
};

BenchDescription Bench() {
  return ReadBenchFile(std::filesystem::path(STRAINWAVE_SOURCE_DIR) / "tests/simulation/field/bench.yaml");
}

RunnerSettings SettingsOf(const BenchDescription& bench) {
  RunnerSettings settings = TestSettings();
  settings.own_thread = true;
  settings.stale_after_s = bench.stale_after_s;
  return settings;
}

class FieldFaults : public testing::TestWithParam<FaultInPhase> {
 protected:
  Observed Meet(const Fault& fault, const schedules::PhaseParameters& phase) {
    const BenchDescription bench = Bench();
    FieldMachine machine(bench, 80.0, {});
    std::atomic<StopRequest> request{StopRequest::kNone};
    const BenchDevices devices = machine.Devices();
    PhaseRunner runner(devices, SettingsOf(bench), request);
    const auto program = MakeProgram(phase, TestSpecimen(), 0.0, bench.control_period_s);
    std::atomic<std::int64_t> injected_ns{-1};
    std::atomic<std::int64_t> safe_ns{-1};
    std::atomic<bool> over{};
    std::thread watch([&] {
      while (!over) {
        if (injected_ns >= 0 && safe_ns < 0 && machine.device_side()->StandsSafe()) {
          safe_ns = devices.clock.Now().count();
        }
        std::this_thread::sleep_for(milliseconds(1));
      }
    });
    int beats = 0;
    Observed observed;
    observed.outcome = runner.Run(*program, [&](const PhaseSnapshot&, const PhaseProgram&) {
      // The third: by then every phase moves something.
      if (++beats != 3) return;
      machine.device_side()->Do(fault.command);
      injected_ns = devices.clock.Now().count();
    });
    // A suspended phase ends with the order to stop; what follows takes the drives' own time.
    const nanoseconds give_up = devices.clock.Now() + kStated;
    while (safe_ns < 0 && devices.clock.Now() < give_up) std::this_thread::sleep_for(milliseconds(1));
    over = true;
    watch.join();
    observed.words = Describe(observed.outcome.reason) + "\n" + machine.Troubles();
    observed.noticed_after = observed.outcome.reason.time - nanoseconds(injected_ns);
    observed.safe_after = safe_ns < 0 ? nanoseconds::max() : nanoseconds(safe_ns - injected_ns);
    EXPECT_GE(injected_ns, 0) << "the phase was over before the fault";
    EXPECT_TRUE(machine.device_side()->StandsSafe());
    return observed;
  }

  void Check(const Fault& fault, std::size_t phase) {
    const Observed observed = Meet(fault, Phases()[phase]);
    const std::string where = std::string(fault.name) + " during " + kPhases[phase] + ": " + observed.words;
    EXPECT_EQ(observed.outcome.reason.cause, fault.cause) << where;
    EXPECT_NE(observed.words.find(fault.words), std::string::npos) << where;
    EXPECT_LT(observed.safe_after, Stated(fault, phase)) << where;
    const auto ms = [](nanoseconds time) { return std::chrono::duration<double, std::milli>(time).count(); };
    std::cout << "| " << fault.name << " | " << kPhases[phase] << " | "
              << static_cast<int>(ms(observed.safe_after)) << " ms | "
              << observed.words.substr(0, observed.words.find('\n')) << " |\n";
  }
};

TEST_P(FieldFaults, EndSafeAndAreNamed) { Check(kFaults[GetParam().fault], GetParam().phase); }

class RefusedObject : public testing::TestWithParam<std::size_t> {};

// In a phase nothing is asked for by SDO: a request for its end is the first thing that ends it. Set up anew,
// the drive is not trusted.
TEST_P(RefusedObject, IsMetWhenTheDriveIsSetUpAnew) {
  const BenchDescription bench = Bench();
  FieldMachine machine(bench, 80.0, {});
  std::atomic<StopRequest> request{StopRequest::kNone};
  PhaseRunner runner(machine.Devices(), SettingsOf(bench), request);
  const auto program = MakeProgram(Phases()[GetParam()], TestSpecimen(), 0.0, bench.control_period_s);
  int beats = 0;
  const PhaseOutcome outcome = runner.Run(*program, [&](const PhaseSnapshot&, const PhaseProgram&) {
    if (++beats == 3) machine.device_side()->Do("drive 1 abort 0x1017 0 on");
    if (beats == 6) request = StopRequest::kQuickStop;
  });
  EXPECT_EQ(outcome.reason.cause, StopCause::kQuickStopRequested) << Describe(outcome.reason);
  request = StopRequest::kNone;
  try {
    machine.MeasureStopTime(RadPerSFromRpm(300.0), TestSettings().limits, request);
    ADD_FAILURE() << "the drive was set up again";
  } catch (const CampaignError& error) {
    EXPECT_NE(std::string(error.what()).find("1017"), std::string::npos) << error.what();
    std::cout << "| SDO access is refused | " << kPhases[GetParam()] << " | " << error.what() << " |\n";
  }
  EXPECT_TRUE(machine.device_side()->StandsSafe());
}

INSTANTIATE_TEST_SUITE_P(Matrix, RefusedObject,
                         testing::Range<std::size_t>(0, std::getenv("STRAINWAVE_FAULT_MATRIX") != nullptr
                                                            ? std::size(kPhases)
                                                            : 1),
                         [](const auto& instance) { return std::string(kPhases[instance.param]); });

// All of them in a load run, and one in each other phase.
INSTANTIATE_TEST_SUITE_P(Matrix, FieldFaults, testing::ValuesIn(FaultsInPhases([](FaultInPhase pair) {
                           return pair.phase == 0 || pair.fault == (pair.phase * 5) % std::size(kFaults);
                         })),
                         NameOf);

}  // namespace
}  // namespace strainwave::bench
