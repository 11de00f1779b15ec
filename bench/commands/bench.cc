// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <memory>
#include <thread>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/units.h"
#include "bench/commands/bench_commands.h"
#include "bench/commands/output.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/errors/bench_error.h"
#include "bench/machines/field/field_machine.h"

namespace strainwave::bench {
namespace {

struct BenchOptions {
  std::string bench;
  bool json{};
};

// What the channels need to be judged in: a second of samples. Their first values are waited for beyond it.
constexpr std::chrono::seconds kLook{2};

int Check(const BenchOptions& options) {
  const BenchDescription bench = ReadBenchFile(options.bench);
  if (bench.simulated) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: a simulated bench has no devices to check (expected simulated: false "
                    "and devices)",
                    options.bench));
  }
  FieldMachine machine(bench, 80.0, {}, FieldMachine::Use::kLook);
  std::this_thread::sleep_for(kLook);
  const std::string missing = machine.AwaitValues([] { return false; });
  const std::vector<FieldMachine::DeviceState> states = machine.States();
  const Readings readings = machine.Devices().sampler.Read();
  const bool good = missing.empty() && readings.bad_channels == 0 &&
                    std::ranges::all_of(states, [](const auto& state) { return state.good; });
  const std::pair<const char*, double> values[] = {
      {"input_angle_deg", DegFromRad(readings.input_angle_rad)},
      {"output_angle_deg", DegFromRad(readings.output_angle_rad)},
      {"input_speed_rpm", RpmFromRadPerS(readings.input_speed_rad_per_s)},
      {"output_torque_Nm", readings.output_torque_Nm},
      {"motor_torque_Nm", readings.motor_torque_Nm},
      {"gear_temperature_degC", readings.gear_temperature_degC},
      {"ambient_temperature_degC", readings.ambient_temperature_degC},
      {"vibration_rms_m_per_s2", readings.vibration_rms_m_per_s2}};
  if (options.json) {
    nlohmann::json document{
        {"good", good}, {"devices", nlohmann::json::array()}, {"channels", nlohmann::json::array()}};
    for (const auto& state : states) {
      nlohmann::json device{{"device", state.device}, {"state", state.state}, {"good", state.good}};
      for (const auto& [name, value] : state.facts) device[name] = value;
      document["devices"].push_back(std::move(device));
    }
    for (unsigned i = 0; i < std::size(values); ++i) {
      document["channels"].push_back({{"channel", values[i].first},
                                      {"value", values[i].second},
                                      {"good", (readings.bad_channels >> i & 1U) == 0}});
    }
    for (const BenchMachine::Finding& finding : machine.Findings()) {
      document["doubts"].push_back({{"refuses", finding.refuses}, {"words", finding.words}});
    }
    if (!missing.empty()) document["missing"] = missing;
    ToStdout("{}\n", document.dump(2));
  } else {
    for (const auto& state : states) {
      ToStdout("{:<5} {:<28} {}\n", state.good ? "good" : "BAD", state.device, state.state);
      for (const auto& [name, value] : state.facts) ToStdout("{:<8}{:<26}{}\n", "", name, value);
    }
    for (unsigned i = 0; i < std::size(values); ++i) {
      ToStdout("{:<5} {:<28} {:.4f}\n", (readings.bad_channels >> i & 1U) == 0 ? "good" : "BAD",
               values[i].first, values[i].second);
    }
    if (!missing.empty()) ToStdout("BAD   {}\n", missing);
    for (const BenchMachine::Finding& finding : machine.Findings())
      ToStdout("{:<5} {}\n", finding.refuses ? "BAD" : "note", finding.words);
    ToStdout("{}\n", good ? "everything answers; nothing was moved"
                          : "not everything is as it should be (see BAD above); nothing was moved");
  }
  return static_cast<int>(good ? ExitCode::kDone : ExitCode::kMachineFailed);
}

}  // namespace

void AddBench(CLI::App& app, Action& action) {
  CLI::App* bench = app.add_subcommand(
      "bench", "Look at the devices of a real bench, turn its shafts by hand, and try its interlocks.");
  bench->require_subcommand(1);
  auto options = std::make_shared<BenchOptions>();
  CLI::App* check = bench->add_subcommand(
      "check",
      "Talk to every device of a bench file: identity, settings that protect, state, first values. Sets the "
      "drives up, "
      "moves nothing, and prints a table.\nExample: strainwave bench check bench/examples/in_process.yaml");
  check->add_option("BENCH", options->bench, "bench file (YAML)")->required();
  check->add_flag("--json", options->json, "the same as JSON on standard output");
  check->callback([options, &action] { action = [options] { return Check(*options); }; });
  AddBenchCommission(*bench, action);
  AddBenchJog(*bench, action);
  AddBenchTripTest(*bench, action);
}

}  // namespace strainwave::bench
