// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/units.h"
#include "bench/commands/bench_commands.h"
#include "bench/commands/moving_limits.h"
#include "bench/commands/output.h"
#include "bench/commands/person.h"
#include "bench/configuration/commissioning_file.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/errors/bench_error.h"
#include "bench/machines/field/field_machine.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

struct CommissionOptions {
  std::string bench;
  std::string speed{"300 rpm"};
  std::string torque{"10 Nm"};
  double ratio{80.0};
  bool yes{};
  bool json{};
};

constexpr double kSpeedReserve = 1.5;

schedules::Limits LimitsOf(const CommissionOptions& options, const BenchDescription& bench, double speed) {
  const double torque_Nm = TorqueLimit_Nm(options.torque, bench);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  return {torque_Nm, kSpeedReserve * std::abs(speed), kGearTemperatureLimit_degC, kNever, kNever};
}

int Commission(const CommissionOptions& options) {
  const BenchDescription bench = ReadBenchFile(options.bench);
  if (bench.simulated) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: a simulated bench has no drives to commission (expected simulated: "
                    "false and devices)",
                    options.bench));
  }
  const double speed = OptionQuantity("--speed", options.speed, schedules::Dimension::kAngularSpeed);
  if (speed == 0.0 || std::abs(speed) > bench.driving_servo.peak_speed_rad_per_s) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("--speed {}: error: not a speed of this bench (expected up to {:g} rpm, the peak "
                    "of its driving servo)",
                    options.speed, RpmFromRadPerS(bench.driving_servo.peak_speed_rad_per_s)));
  }
  const schedules::Limits limits = LimitsOf(options, bench, speed);
  ListenForQuickStop();
  const LiveOutput output([] { return Requested() != StopRequest::kNone; });
  if (!options.yes &&
      !Ask(fmt::format(
          "the shafts will turn, the input at {:g} rpm, and be left to stop by themselves: keep clear, "
          "have the emergency stop at hand",
          RpmFromRadPerS(speed)))) {
    throw BenchError(ExitCode::kInterrupted,
                     "nobody has confirmed, nothing was moved (expected a person at the terminal, or --yes)");
  }
  FieldMachine machine(bench, options.ratio, Ask);
  WaitForPeople(machine);
  WaitForValues(machine);
  const std::vector<MeasuredStop> stops = machine.MeasureStopTime(speed, limits, Requested());
  const std::filesystem::path file = CommissioningFileOf(options.bench);
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  daq::WriteFileAtomically(file, CommissioningText(stops));
  bool good = true;
  nlohmann::ordered_json document{{"file", file.string()}, {"drives", nlohmann::ordered_json::array()}};
  for (const MeasuredStop& stop : stops) {
    const StopTimeFinding finding = JudgeStopTime(stop.servo, &stop, stop.identity, bench.longest_stop_s);
    good = good && finding.words.empty();
    document["drives"].push_back({{"servo", stop.servo},
                                  {"identity", stop.identity},
                                  {"left_enabled_s", stop.left_enabled_s},
                                  {"stood_s", stop.stood_s},
                                  {"good", finding.words.empty()}});
    if (options.json) continue;
    ToStdout("{:<5} {:<14} left enabled after {:.0f} ms, stood after {:.0f} ms ({})\n",
             finding.words.empty() ? "good" : "BAD", stop.servo, 1e3 * stop.left_enabled_s,
             1e3 * stop.stood_s, stop.identity);
    if (!finding.words.empty()) ToStdout("      {}\n", finding.words);
  }
  if (options.json) {
    ToStdout("{}\n", document.dump(2));
  } else {
    ToStdout("kept in {}\n", file.string());
  }
  return static_cast<int>(good ? ExitCode::kDone : ExitCode::kMachineFailed);
}

}  // namespace

void AddBenchCommission(CLI::App& bench, Action& action) {
  CLI::App* command = bench.add_subcommand(
      "commission",
      "Measure how long the drives take to stop when this program is gone: turns the input, falls silent and "
      "watches. Asks before anything moves. The result is kept beside the bench file (of an example in "
      "campaigns/), shown by bench check, "
      "and looked at when a campaign starts.\n"
      "Example: strainwave bench commission bench/examples/in_process.yaml");
  auto options = std::make_shared<CommissionOptions>();
  command->add_option("BENCH", options->bench, "bench file (YAML)")->required();
  command->add_option("--speed", options->speed, "of the input, from which it is left to stop")
      ->capture_default_str();
  command->add_option("--torque", options->torque, "output torque at which it ends")->capture_default_str();
  command->add_option("--ratio", options->ratio, "of the gear, input turns for one of the output")
      ->capture_default_str();
  command->add_flag("--yes", options->yes,
                    "do not ask: somebody has seen to it that nobody is near the shafts");
  command->add_flag("--json", options->json, "the same as JSON on standard output");
  command->callback([options, &action] { action = [options] { return Commission(*options); }; });
}

}  // namespace strainwave::bench
