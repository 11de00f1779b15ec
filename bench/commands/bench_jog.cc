// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "analysis/units.h"
#include "bench/campaign/runner_settings.h"
#include "bench/commands/bench_commands.h"
#include "bench/commands/hand.h"
#include "bench/commands/moving_limits.h"
#include "bench/commands/output.h"
#include "bench/commands/person.h"
#include "bench/commands/terminal.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/controller/jog_program.h"
#include "bench/errors/bench_error.h"
#include "bench/machines/make_machine.h"

namespace strainwave::bench {
namespace {

using std::chrono::milliseconds;

struct JogOptions {
  std::string bench;
  JogDrive drive{};
  std::string speed{"2 rpm"};
  std::string torque{"5 Nm"};
  double ratio{80.0};
};

// Keyboards repeat a key after half a second or a little more, then every 30 ms.
constexpr milliseconds kHoldsFor{700};
constexpr double kMostShareOfPeakSpeed = 0.05;
constexpr double kSpeedUp_s = 0.5;                  // from rest
constexpr double kJogSpeedReserve = 2.0;            // the limit lies so far above what is asked for,
constexpr double kSpeedReserveFromBehind = 4.0;     // (a gear that is turned by its output breaks loose)
constexpr double kLeastSpeedLimit_rad_per_s = 2.0;  // and not below this: slow speeds are read with noise

double SpeedOf(const JogOptions& options, const BenchDescription& bench) {
  const double speed = OptionQuantity("--speed", options.speed, schedules::Dimension::kAngularSpeed);
  const bool driving = options.drive == JogDrive::kDriving;
  const double peak = driving ? bench.driving_servo.peak_speed_rad_per_s
                              : bench.load_servo.peak_speed_rad_per_s / bench.load_reducer_ratio;
  const double most = kMostShareOfPeakSpeed * peak;
  if (speed != 0.0 && std::abs(speed) <= most) return speed;
  throw BenchError(
      ExitCode::kWrongInput,
      fmt::format(
          "--speed {}: error: not a speed to jog the {} servo at (expected up to {:.4g} rpm, {:.0f} % of "
          "its peak speed at the axis; negative for the other direction)",
          options.speed, driving ? "driving" : "load", RpmFromRadPerS(most), 100 * kMostShareOfPeakSpeed));
}

RunnerSettings SettingsOf(const JogOptions& options, const BenchDescription& bench, double speed_rad_per_s,
                          double torque_Nm) {
  const bool from_behind = options.drive == JogDrive::kLoad;
  const double most_input_rad_per_s =
      std::abs(speed_rad_per_s) *
      (from_behind ? kSpeedReserveFromBehind * std::abs(options.ratio) : kJogSpeedReserve);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  RunnerSettings settings = RunnerSettingsOf(bench);
  settings.limits = {.output_torque_Nm = torque_Nm,
                     .input_speed_rad_per_s = std::max(most_input_rad_per_s, kLeastSpeedLimit_rad_per_s),
                     .gear_temperature_degC = kGearTemperatureLimit_degC,
                     .vibration_rms_m_per_s2 = kNever,
                     .twist_rad = kNever};
  // A person is there; nothing suspends and goes on by itself.
  settings.suspend = {kNever, kNever, 0.0, kNever, 0.0};
  return settings;
}

bool StandsSafe(const BenchDevices& devices) {
  const auto off = [](const DriveActual& drive) {
    return drive.brake_engaged && drive.power != protocols::PowerState::kOperationEnabled;
  };
  return off(devices.driving.Actual()) && off(devices.load.Actual());
}

bool WaitUntilSafe(const BenchDevices& devices) {
  constexpr milliseconds kAskEvery{10};
  constexpr int kLooks = 300;
  for (int i = 0; i < kLooks && !StandsSafe(devices); ++i) {
    devices.clock.SleepUntil(devices.clock.Now() + kAskEvery);
  }
  return StandsSafe(devices);
}

int CodeOf(const StopReason& reason) {
  if (IsRequest(reason.cause)) {
    // A terminal that is closed is a signal and the end of the input, whichever is seen first.
    const bool signalled = Requested() == StopRequest::kQuickStop;
    return static_cast<int>(signalled ? ExitCode::kInterrupted : ExitCode::kDone);
  }
  return static_cast<int>(IsOfADevice(reason.cause) ? ExitCode::kMachineFailed : ExitCode::kEndedBadly);
}

int Jog(const JogOptions& options) {
  const BenchDescription bench = ReadBenchFile(options.bench);
  const double speed = SpeedOf(options, bench);
  const double torque_Nm = TorqueLimit_Nm(options.torque, bench);
  ListenForQuickStop();
  const LiveOutput output([] { return Requested() != StopRequest::kNone; });
  SimulatedTest test;
  test.ratio = options.ratio;
  const auto machine = MakeMachine(bench, test, Ask);
  WaitForPeople(*machine);
  WaitForValues(*machine);
  BenchDevices devices = machine->Devices();
  const bool driving = options.drive == JogDrive::kDriving;
  const auto angle_deg = [&](const Readings& readings) {
    return DegFromRad(driving ? readings.input_angle_rad : readings.output_angle_rad);
  };
  const double start_deg = angle_deg(devices.sampler.Read());
  DeadMan dead_man(kHoldsFor);
  JogProgram program(
      {options.drive, speed, std::abs(speed) / kSpeedUp_s, bench.control_period_s},
      [&](std::chrono::nanoseconds now) { return dead_man.IsHeld(now) || machine->StartKeyHeld(); });
  PhaseRunner runner(devices, SettingsOf(options, bench, speed, torque_Nm), Requested());
  ToStderr(
      "the {} servo turns at {:g} rpm while space or Enter (or start on the pendant) is held; let go, it "
      "stops within {} ms; q or Ctrl-C ends\n",
      driving ? "driving" : "load", RpmFromRadPerS(speed), kHoldsFor.count());
  TerminalLine line;
  PhaseOutcome outcome;
  {
    const Hand hand(dead_man, devices.clock, [] { Request(StopRequest::kShutdown); });
    outcome = runner.Run(program, [&](const PhaseSnapshot& now, const PhaseProgram&) {
      const std::string text =
          fmt::format("{:.2f} deg turned, {:.2f} Nm at the output", angle_deg(now.readings) - start_deg,
                      now.readings.output_torque_Nm);
      if (StderrIsTerminal()) {
        line.Show(text);
      } else {
        ToStderr("{}\n", text);
      }
    });
  }
  line.Clear();
  const bool safe = WaitUntilSafe(devices);
  if (outcome.reason.cause != StopCause::kShutdownRequested) {
    ToStderr("{}\n", Describe(outcome.reason));
    if (const std::string troubles = machine->Troubles(); !troubles.empty()) ToStderr("{}\n", troubles);
  }
  ToStdout("the {} turned {:.2f} deg; {}\n", driving ? "motor's shaft" : "output",
           angle_deg(devices.sampler.Read()) - start_deg,
           safe ? "torque is off, the brakes are on"
                : "the drives do not say that torque is off and the brakes are on: use the emergency stop");
  return safe ? CodeOf(outcome.reason) : static_cast<int>(ExitCode::kMachineFailed);
}

}  // namespace

void AddBenchJog(CLI::App& bench, Action& action) {
  CLI::App* jog = bench.add_subcommand(
      "jog",
      "Turn one drive slowly while a hand holds a key; the other drive lets itself be turned. Let go, torque "
      "is off and the brakes are on; so it is on every way out. Torque and speed are watched.\n"
      "Example: strainwave bench jog bench/examples/in_process.yaml --drive driving --speed \"2 rpm\"");
  auto options = std::make_shared<JogOptions>();
  jog->add_option("BENCH", options->bench, "bench file (YAML)")->required();
  jog->add_option("--drive", options->drive, "driving or load")
      ->required()
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, JogDrive>{{"driving", JogDrive::kDriving}, {"load", JogDrive::kLoad}}));
  jog->add_option("--speed", options->speed,
                  "at the drive's axis, behind its reducer; negative: the other way")
      ->capture_default_str();
  jog->add_option("--torque", options->torque, "output torque at which it stops")->capture_default_str();
  jog->add_option("--ratio", options->ratio, "of the gear, input turns for one of the output")
      ->check(CLI::TypeValidator<double>())
      ->capture_default_str();
  jog->callback([options, &action] { action = [options] { return Jog(*options); }; });
}

}  // namespace strainwave::bench
