// SPDX-License-Identifier: Apache-2.0
// strainwave-devices: the simulated bench as separate devices on real buses.
#include <unistd.h>
#include <atomic>
#include <chrono>
#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "bench/commands/output.h"
#include "bench/commands/signals.h"
#include "bench/commands/version.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/devices/can/socket_can_bus.h"
#include "bench/devices/monotonic_clock.h"
#include "bench/devices/wake.h"
#include "bench/errors/bench_error.h"
#include "bench/machines/device_side/device_side.h"
#include "bench/machines/plant_model_of.h"
#include "bench/realtime/realtime.h"

namespace strainwave::bench {
namespace {

std::atomic<bool> g_ending{};

// In truth, whatever the drives say; the time is the kernel's, as another program may have it.
std::string StateOf(DeviceSide& devices, const MonotonicClock& clock) {
  const std::optional<std::chrono::nanoseconds> since = devices.SafeSince();
  if (!since) return "state: not safe";
  const auto kernel = std::chrono::duration<double>(*since - clock.FromKernel({}));
  return fmt::format("state: torque off and brakes on since {:.6f} s of CLOCK_MONOTONIC", kernel.count());
}

std::string AnswerTo(const std::string& line, DeviceSide& devices, const MonotonicClock& clock) {
  if (line == "help")
    return DeviceSide::Commands() +
           std::string("\nstate                               whether the shafts are safe, and since when");
  if (line == "state") return StateOf(devices, clock);
  return devices.Do(line);
}

// One line of standard input at a time, while the devices go on.
void Listen(DeviceSide& devices, const MonotonicClock& clock) {
  std::string line;
  while (!g_ending) {
    if (WaitReadable(STDIN_FILENO, nullptr, std::chrono::milliseconds(100)) != Waited::kReadable) continue;
    if (!std::getline(std::cin, line)) return;  // nobody will say anything any more
    if (line.empty()) continue;
    if (line == "quit") {
      g_ending = true;
      return;
    }
    try {
      ToStdout("{}\n", AnswerTo(line, devices, clock));
    } catch (const std::exception& error) {
      ToStdout("error: {} ({})\n", line, error.what());
    }
  }
}

int Run(const std::string& file, double ratio, double period_ms) {
  const BenchDescription bench = ReadBenchFile(file);
  ListenToSignals([](int, pid_t) { g_ending = true; });
  const MonotonicClock clock;
  std::vector<std::unique_ptr<CanBus>> ends;
  DeviceSideBuses buses;
  for (const DeviceDescription& device : bench.devices) {
    if (device.kind != DeviceDescription::Kind::kCanopen) continue;
    SocketCanSettings settings;
    settings.interface = device.address;
    settings.transmit_frames = 64;
    settings.clock_zero = -clock.FromKernel({});
    for (const ServoDescription* servo : {&bench.driving_servo, &bench.load_servo}) {
      if (servo->drive.device != device.name) continue;
      settings.filters = FiltersOfNode(servo->drive.node);
      ends.push_back(std::make_unique<SocketCanBus>(settings));
      buses[device.name].push_back(ends.back().get());
    }
  }
  DeviceSide devices(bench, PlantModelOf(bench, ratio), buses);
  for (const DeviceDescription& device : bench.devices) {
    const std::string address = devices.AddressOf(device.name);
    ToStdout("{}: {}\n", device.name, address.empty() ? device.address : address);
  }
  ToStdout("ready; a line of standard input is a command (help, quit)\n");
  std::thread listener([&] { Listen(devices, clock); });
  if (const std::string refused = BecomeRealtime(RealtimeRank::kDeviceSide); !refused.empty()) {
    ToStderr("warning: {}\n", refused);
  }
  const std::chrono::nanoseconds period(static_cast<std::int64_t>(1e6 * period_ms));
  RunInRealTime(devices, clock, g_ending, {}, period);
  listener.join();
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace
}  // namespace strainwave::bench

int main(int argc, char** argv) {
  using strainwave::bench::ExitCode, strainwave::bench::ToStderr;
  strainwave::bench::PrepareOutput();
  if (const auto answered = strainwave::bench::AnswerVersion(argc, argv)) return *answered;
  CLI::App app(
      "strainwave-devices plays the devices that a bench file names: two drives on CAN or Modbus, Modbus "
      "servers, streams of samples, with the simulated bench behind them. Faults come on command, by "
      "standard input.\n"
      "Example: strainwave-devices bench/examples/can.yaml\n"
      "Where the kernel has no CAN: a bench file with 'interface: in_process' needs no strainwave-devices.");
  std::string file;
  double ratio = 80.0;
  app.add_option("BENCH", file, "bench file (YAML)")->required();
  app.add_option("--ratio", ratio, "of the gear, input turns for one of the output")->capture_default_str();
  double period_ms = 0.0;
  app.add_option("--period", period_ms,
                 "ms between two looks at the buses; on a slow machine longer than the bench file's "
                 "fast_control_period, the least")
      ->check(CLI::Range(0.0, 100.0));
  app.add_flag("--version", strainwave::bench::kVersionHelp);
  CLI11_PARSE(app, argc, argv);
  try {
    return strainwave::bench::Run(file, ratio, period_ms);
  } catch (const strainwave::schedules::FileError& error) {
    ToStderr("{}\n", error.what());
    return static_cast<int>(ExitCode::kWrongInput);
  } catch (const std::invalid_argument& error) {
    ToStderr("{}: error: {}\n", file, error.what());
    return static_cast<int>(ExitCode::kWrongInput);
  } catch (const std::exception& error) {
    ToStderr("{}: error: {}\n", file, error.what());
    return static_cast<int>(ExitCode::kMachineFailed);
  }
}
