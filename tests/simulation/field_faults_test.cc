// SPDX-License-Identifier: Apache-2.0
// Faults of devices during phases, over the real protocols and in real time: the shafts are safe within the
// stated time, and the reason is named. The whole matrix, for docs/bench/faults.md:
// STRAINWAVE_FAULT_MATRIX=1.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <iostream>
#include <thread>
#include <tuple>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "bench/configuration/read_bench_file.h"
#include "bench/configuration/read_drive_profile.h"
#include "bench/configuration/read_register_map.h"
#include "bench/controller/make_program.h"
#include "bench/errors/bench_error.h"
#include "bench/machines/field/field_machine.h"
#include "tests/checkout.h"
#include "tests/simulation/bench_fixture.h"
#include "tests/simulation/device_faults.h"

namespace strainwave::bench::field_faults_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr double kLongEnough_s = 12.0;  // for the slowest fault to be noticed

schedules::SensorCheck SensorCheckOf(schedules::SensorCheck::Kind kind, double duration_s) {
  schedules::SensorCheck check;
  check.kind = kind;
  check.duration_s = duration_s;
  return check;
}

// In the order of kPhases.
std::vector<schedules::PhaseParameters> Phases() {
  schedules::MeasurementRotation rotation = TestRotation();
  rotation.turns = 20;  // long enough for a fault to meet it
  rotation.vibration_rate_hz = 12800.0;
  schedules::HysteresisTest hysteresis = TestHysteresis();
  hysteresis.torque_rate_Nm_per_s = 20.0;
  hysteresis.lock_angles_rad = {0.0, kPi};  // so far that a slow servo is not nearly there
  schedules::Soak soak;
  soak.at_most_s = kLongEnough_s;
  schedules::BlankTest blank;
  blank.peak_torque_Nm = hysteresis.peak_torque_Nm;
  blank.torque_rate_Nm_per_s = hysteresis.torque_rate_Nm_per_s;
  return {TestLoadRun(60.0),
          rotation,
          TestSweep(),
          hysteresis,
          soak,
          blank,
          SensorCheckOf(schedules::SensorCheck::Kind::kZero, kLongEnough_s),
          SensorCheckOf(schedules::SensorCheck::Kind::kShunt, kLongEnough_s / 2.0),
          SensorCheckOf(schedules::SensorCheck::Kind::kReference, kLongEnough_s)};
}

// Each fault on CAN in a load run, and one of them in each other phase; each on Modbus in a phase of the two
// that every bench can run, by turns.
bool IsOnceOfItsRow(FaultInPhase pair) {
  const bool is_on_can = Faults()[pair.fault].bench == TestedBench::kCan;
  if (!is_on_can) return pair.phase == pair.fault % 2;
  return pair.phase == 0 || pair.fault == (pair.phase * 5) % FaultsOnCan().size();
}

// Of those one in each other phase, and of each protocol the first with each reason for a stop.
bool IsInEveryRun(FaultInPhase pair) {
  if (!IsOnceOfItsRow(pair)) return false;
  const auto kind = [](const Fault& fault) {
    const bool is_on_line = fault.name.find("Modbus RTU") != std::string::npos;
    return std::tuple(fault.bench == TestedBench::kCan, is_on_line, fault.cause, fault.or_cause);
  };
  const Fault& fault = Faults()[pair.fault];
  if (fault.bench == TestedBench::kCan && pair.phase != 0) return true;
  return &*std::ranges::find(Faults(), kind(fault), kind) == &fault;
}

bool IsOnlyAtLength(FaultInPhase pair) { return IsOnceOfItsRow(pair) && !IsInEveryRun(pair); }

// Of torque, angle and speed at the shafts; a torque beyond the end of its converter has no value.
bool IsLimit(StopCause cause) {
  return cause == StopCause::kOutputTorqueLimit || cause == StopCause::kInputSpeedLimit ||
         cause == StopCause::kTwistLimit || cause == StopCause::kImplausibleReading;
}

struct Observed {
  StopReason reason;
  bool in_next_phase{};   // the phase came to its end
  std::string troubles;   // of the devices, in words
  double over_after_s{};  // the bench has noticed, and both shafts are safe
};

BenchDescription Bench(TestedBench bench = TestedBench::kCan) { return ReadBenchFile(BenchFileOf(bench)); }

RunnerSettings SettingsOf(const BenchDescription& bench) {
  RunnerSettings settings = TestSettings();
  settings.own_thread = true;
  settings.stale_after_s = bench.stale_after_s;
  return settings;
}

void WaitForReadings(FieldMachine& machine) {
  EXPECT_EQ(machine.AwaitValues([] { return false; }), "");
}

// A line for fault_matrix_table.py.
void PrintCell(FaultInPhase cell, const std::string& fault, const std::string& times,
               const std::string& words) {
  std::cout << fmt::format("cell {} {} | {} | {} | {} | {}\n", cell.fault, cell.phase, fault,
                           kPhases[cell.phase].name, times, words);
}

class FieldFaults : public testing::TestWithParam<FaultInPhase> {
 protected:
  Observed Meet(const Fault& fault, std::size_t phase) {
    const BenchDescription bench = Bench(fault.bench);
    FieldMachine machine(bench, 80.0, {});
    WaitForReadings(machine);
    std::atomic<StopRequest> request{StopRequest::kNone};
    BenchDevices devices = machine.Devices();
    SpyDrive load(devices.load, devices.clock);
    PhaseRunner runner({devices.driving, load, devices.sampler, devices.clock}, SettingsOf(bench), request);
    const auto program = MakeProgram(Phases()[phase], TestSpecimen(), 0.0, bench.control_period_s);
    std::atomic<std::int64_t> injected_ns{-1};
    std::atomic<std::int64_t> safe_ns{-1};
    std::atomic<bool> over{};
    std::thread watch([&] {
      while (!over) {
        const bool is_safe = machine.device_side()->StandsSafe();
        if (injected_ns < 0 || !is_safe) safe_ns = -1;
        if (injected_ns >= 0 && is_safe && safe_ns < 0) safe_ns = devices.clock.Now().count();
        std::this_thread::sleep_for(milliseconds(1));
      }
    });
    int beats = 0;
    const auto inject = [&] {
      if (beats++ != BeatIn(fault, kPhases[phase])) return;
      machine.device_side()->Do(CommandIn(fault, kPhases[phase]));
      injected_ns = devices.clock.Now().count();
    };
    inject();
    Observed observed;
    observed.reason =
        runner.Run(*program, [&](const PhaseSnapshot&, const PhaseProgram&) { inject(); }).reason;
    if (!observed.reason) {
      observed.in_next_phase = true;
      const auto next = MakeProgram(TestLoadRun(10.0), TestSpecimen(), 0.0, bench.control_period_s);
      observed.reason = runner.Run(*next, NoHeartbeat).reason;
    }
    // A suspended phase ends with the order to stop; what follows takes the drives' own time.
    const nanoseconds give_up = devices.clock.Now() + seconds(5);
    while (safe_ns < 0 && devices.clock.Now() < give_up) std::this_thread::sleep_for(milliseconds(1));
    over = true;
    watch.join();
    observed.troubles = machine.Troubles();
    const nanoseconds last = std::max(load.last_quick_stop_at, nanoseconds(safe_ns));
    observed.over_after_s = std::chrono::duration<double>(last - nanoseconds(injected_ns)).count();
    EXPECT_GE(injected_ns, 0) << "the phase was over before the fault";
    EXPECT_TRUE(machine.device_side()->StandsSafe());
    return observed;
  }

  void Check(const Fault& fault, std::size_t number) {
    const TestedPhase& phase = kPhases[number];
    const Observed observed = Meet(fault, number);
    const std::string reason = Describe(observed.reason);
    const std::string where =
        fmt::format("{} during {}: {}\n{}", fault.name, phase.name, reason, observed.troubles);
    const bool breaks_limit = fault.breaks_limits && ShowsIn(fault, phase) && IsLimit(observed.reason.cause);
    const bool is_other = fault.or_cause != StopCause::kNone && observed.reason.cause == fault.or_cause;
    EXPECT_TRUE(breaks_limit || is_other || observed.reason.cause == CauseIn(fault, phase)) << where;
    if (CauseIn(fault, phase) == StopCause::kNone) return PrintCell(GetParam(), fault.name, "– | –", "");
    const bool says_so = where.find(fault.words, where.find(':')) != std::string::npos;
    EXPECT_TRUE(breaks_limit || says_so) << where;
    EXPECT_EQ(observed.in_next_phase, !ShowsIn(fault, phase)) << where;
    std::string times = "– | –";
    if (ShowsIn(fault, phase)) {
      const double stated_s = StatedTime_s(fault, phase);
      EXPECT_LT(observed.over_after_s, stated_s) << where;
      times = fmt::format("{:.0f} | {:.0f}", 1e3 * observed.over_after_s, 1e3 * stated_s);
    }
    const bool by_drive = observed.reason.cause == StopCause::kDriveFault && !observed.troubles.empty();
    const std::string words = by_drive ? observed.troubles.substr(0, observed.troubles.find('\n')) : reason;
    PrintCell(GetParam(), fault.name, times, words);
  }
};

TEST(StatedTimes, AreThoseOfTheFiles) {
  const auto source = std::filesystem::path(SourceFolder());
  const BenchDescription bench = Bench();
  EXPECT_EQ(bench.stale_after_s, kReadings_s);
  EXPECT_EQ(bench.control_period_s, kControlPeriod_s);
  const auto drive = ReadDriveProfile(source / "tests/simulation/field/drive.yaml");
  EXPECT_EQ(1e-3 * drive.supervision.drive_timeout_ms, kHeartbeat_s);
  const auto s = [](nanoseconds time) { return std::chrono::duration<double>(time).count(); };
  EXPECT_EQ(s(drive.timing.sync_period), kSyncPeriod_s);
  EXPECT_EQ(s(drive.timing.sync_period * drive.timing.stale_after_syncs), kMissing_s);
  EXPECT_EQ(1e-3 * drive.supervision.rpdo_event_timer_ms, kUnheard_s);
  EXPECT_EQ(drive.limits.quick_stop_deceleration_rad_per_s2, kDeceleration_rad_per_s2);
  for (const TestedBench other : {TestedBench::kModbus, TestedBench::kModbusLoad}) {
    EXPECT_EQ(Bench(other).stale_after_s, kReadings_s);
    EXPECT_EQ(Bench(other).control_period_s, kControlPeriod_s);
  }
  const auto modbus = ReadModbusProfile(source / "tests/simulation/field/modbus_drive.yaml");
  EXPECT_EQ(s(modbus.servo->period), kWritePeriod_s);
  EXPECT_EQ(s(modbus.servo->watchdog_time), kWatchdog_s);
  EXPECT_EQ(s(ModbusSettings().answer_time), kAnswer_s);
  EXPECT_EQ(s(ModbusSettings().first_pause), kReconnect_s);
  for (const auto& [name, poll_s] : {std::pair{"status", kStatePoll_s},
                                     {"actual_speed", kStatePoll_s},
                                     {"actual_torque", kStatePoll_s},
                                     {"brake", kBrakePoll_s},
                                     {"watchdog", kBrakePoll_s}}) {
    EXPECT_EQ(s(modbus.map.registers[*protocols::modbus::Find(modbus.map, name)].poll_period), poll_s);
  }
  const auto climate = ReadModbusProfile(source / "bench/devices/profiles/strainwave_climate.yaml");
  EXPECT_EQ(s(climate.map.registers.front().poll_period), kPoll_s);
  EXPECT_EQ(s(climate.map.registers.front().good_for), kGoodFor_s);
  EXPECT_EQ(TestSettings().suspend.bad_sensor_s, kBadSensor_s);
  EXPECT_EQ(TestSettings().suspend.trip_temperature_degC, kTrip_degC);
  EXPECT_EQ(TestSettings().limits.output_torque_Nm, kTorqueLimit_Nm);
}

TEST_P(FieldFaults, EndSafeAndAreNamed) { Check(Faults()[GetParam().fault], GetParam().phase); }

// The cells of drives that cannot run the phase at all.
TEST(DrivesOnModbus, DoNotMoveToPositions) {
  for (std::size_t phase = 0; phase < std::size(kPhases); ++phase) {
    if (RunsOn(TestedBench::kModbus, kPhases[phase])) continue;
    const BenchDescription bench = Bench(TestedBench::kModbus);
    FieldMachine machine(bench, 80.0, {});
    WaitForReadings(machine);
    std::atomic<StopRequest> request{StopRequest::kNone};
    PhaseRunner runner(machine.Devices(), SettingsOf(bench), request);
    const auto program = MakeProgram(Phases()[phase], TestSpecimen(), 0.0, bench.control_period_s);
    EXPECT_EQ(runner.Run(*program, NoHeartbeat).reason.cause, StopCause::kDriveNotReady);
    EXPECT_TRUE(machine.device_side()->StandsSafe());
    for (std::size_t fault = 0; fault < Faults().size(); ++fault) {
      if (Faults()[fault].bench == TestedBench::kModbus) {
        PrintCell({fault, phase}, Faults()[fault].name, "× | –", "");
      }
    }
  }
}

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
  } catch (const BenchError& error) {
    EXPECT_NE(std::string(error.what()).find("1017"), std::string::npos) << error.what();
    PrintCell({Faults().size(), GetParam()}, "SDO access is refused", "– | –", error.what());
  }
  EXPECT_TRUE(machine.device_side()->StandsSafe());
}

INSTANTIATE_TEST_SUITE_P(Matrix, RefusedObject,
                         testing::Range<std::size_t>(0, std::getenv("STRAINWAVE_FAULT_MATRIX") != nullptr
                                                            ? std::size(kPhases)
                                                            : 1),
                         [](const auto& instance) { return std::string(kPhases[instance.param].name); });

INSTANTIATE_TEST_SUITE_P(Matrix, FieldFaults,
                         testing::ValuesIn(FaultsInPhases(std::size(kPhases), IsInEveryRun)), NameOfCell);

class FieldFaultsAtLength : public FieldFaults {};

TEST_P(FieldFaultsAtLength, EndSafeAndAreNamed) { Check(Faults()[GetParam().fault], GetParam().phase); }

INSTANTIATE_TEST_SUITE_P(Matrix, FieldFaultsAtLength,
                         testing::ValuesIn(FaultsInPhases(std::size(kPhases), IsOnlyAtLength)), NameOfCell);

}  // namespace
}  // namespace strainwave::bench::field_faults_test
