// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/configuration/read_drive_profile.h"
#include "bench/configuration/read_hid_profile.h"
#include "bench/devices/modbus/modbus_address.h"
#include "bench/devices/monotonic_clock.h"
#include "bench/errors/bench_error.h"
#include "bench/installation.h"
#include "bench/machines/device_side/played_bench.h"
#include "bench/machines/listing/find_devices.h"

namespace strainwave::bench {
namespace {

using Kind = DeviceDescription::Kind;

struct DevicesOptions {
  std::string bench;
  std::vector<std::string> can;
  std::vector<std::string> modbus;
  std::string units{"1-16"};
  int answer_ms{200};
  std::string profiles;
  bool json{};
};

// The devices that a bench file names; those within this program live as long as this.
struct NamedDevices {
  explicit NamedDevices(const std::string& file) {
    if (file.empty()) return;
    bench = ReadBenchFile(file);
    if (bench->simulated) {
      throw BenchError(ExitCode::kWrongInput,
                       fmt::format("{}: error: a simulated bench has no devices to look for (expected "
                                   "simulated: false and devices)",
                                   file));
    }
    played.emplace(*bench, 80.0, clock);
    // What has just been switched on does not answer at once.
    constexpr std::chrono::milliseconds kToBoot{200};
    if (played->devices() != nullptr) clock.SleepUntil(clock.Now() + kToBoot);
  }

  MonotonicClock clock;
  std::optional<BenchDescription> bench;
  std::optional<PlayedBench> played;
};

KnownProfiles ProfilesFor(const DevicesOptions& options, const NamedDevices& named) {
  KnownProfiles known;
  known.AddFolder(options.profiles.empty() ? DataFile("bench/devices/profiles")
                                           : std::filesystem::path(options.profiles));
  if (!named.bench) return known;
  for (const ServoDescription* servo : {&named.bench->driving_servo, &named.bench->load_servo}) {
    if (!servo->drive.profile.empty())
      known.drives[servo->drive.profile] = ReadDriveProfile(servo->drive.profile);
  }
  for (const DeviceDescription& device : named.bench->devices) {
    const bool is_hid =
        device.kind == Kind::kHid || device.kind == Kind::kPendant || device.kind == Kind::kStoContact;
    if (is_hid) known.hid[device.file] = ReadHidProfile(device.file);
  }
  return known;
}

FoundPart FindCan(const DevicesOptions& options, NamedDevices& named, const KnownProfiles& known) {
  FoundPart part{"can", {}, {}};
  std::set<std::string> interfaces(options.can.begin(), options.can.end());
  for (const std::string& interface : CanInterfaces()) interfaces.insert(interface);
  if (named.bench) {
    for (const DeviceDescription& device : named.bench->devices) {
      if (device.kind != Kind::kCanopen) continue;
      if (CanBus* const bus = named.played->Bus(device.name)) {
        FindOnCan(*bus, named.clock, kInProcess.data(), known, part);
      } else {
        interfaces.insert(device.address);
      }
    }
  }
  if (const std::string missing = MissingCan(); !missing.empty()) {
    part.notes.push_back(missing);
    return part;
  }
  for (const std::string& interface : interfaces) FindOnCan(interface, known, part);
  if (interfaces.empty()) {
    part.notes.emplace_back(
        "there is no CAN interface (ip link show type can; a USB adapter needs its driver; for a virtual "
        "one: "
        "ip link add dev vcan0 type vcan; ip link set up vcan0)");
  }
  return part;
}

std::pair<int, int> UnitsOf(const std::string& text) {
  int first = 0;
  int last = 0;
  int used = 0;
  const bool is_range = std::sscanf(text.c_str(), "%d-%d%n", &first, &last, &used) == 2;
  if (!is_range && std::sscanf(text.c_str(), "%d%n", &first, &used) == 1) last = first;
  if (static_cast<std::size_t>(used) != text.size() || first < 1 || last < first || last > 247) {
    throw std::invalid_argument(
        fmt::format("--units {} is not usable (expected one unit or FIRST-LAST, from 1 to 247)", text));
  }
  return {first, last};
}

FoundPart FindModbus(const DevicesOptions& options, const NamedDevices& named) {
  FoundPart part{"modbus", {}, {}};
  const auto look = [&](const std::string& address, int first, int last) {
    ModbusSettings settings;
    settings.port = ParseModbusAddress(address);
    settings.answer_time = std::chrono::milliseconds(options.answer_ms);
    FindOnModbus(settings, first, last, address, part);
  };
  const auto [first, last] = UnitsOf(options.units);
  for (const std::string& address : options.modbus) look(address, first, last);
  bool any = !options.modbus.empty();
  if (named.bench) {
    for (const DeviceDescription& device : named.bench->devices) {
      if (!IsOnModbus(device.kind)) continue;
      any = true;
      look(named.played->AddressOf(device), device.unit, device.unit);
    }
  }
  if (!any) {
    part.notes.emplace_back(
        "nowhere to look: a Modbus port does not show what is on it (name one: --modbus tcp://HOST:PORT or "
        "--modbus rtu:/dev/ttyUSB0:19200:8E1, or a bench file)");
  }
  return part;
}

nlohmann::ordered_json Json(const FoundPart& part) {
  nlohmann::ordered_json json{{"devices", nlohmann::ordered_json::array()}, {"notes", part.notes}};
  for (const FoundDevice& device : part.devices) {
    nlohmann::ordered_json entry{{"where", device.where}, {"what", device.what}};
    for (const auto& [name, value] : device.fields) {
      std::visit([&, key = name](const auto& plain) { entry[key] = plain; }, value);
    }
    if (!device.profile.empty()) entry["profile"] = device.profile;
    json["devices"].push_back(std::move(entry));
  }
  return json;
}

void Print(const FoundPart& part) {
  constexpr std::pair<std::string_view, const char*> kTitles[] = {
      {"can", "CAN"}, {"modbus", "Modbus"}, {"hid", "HID"}, {"iio", "IIO"}, {"camera", "Cameras"}};
  ToStdout("{}\n", std::ranges::find(kTitles, part.kind, [](const auto& row) { return row.first; })->second);
  for (const FoundDevice& device : part.devices) {
    ToStdout("  {:<28} {}\n", device.where, device.what);
    std::string details;
    for (const auto& [name, value] : device.fields) {
      const auto* const text = std::get_if<std::string>(&value);
      // What stands in the line above is not said twice.
      const bool said = text == nullptr || text->empty() || device.where.find(*text) != std::string::npos ||
                        device.what.find(*text) != std::string::npos;
      if (!said) details += fmt::format("{}{} {}", details.empty() ? "" : ", ", name, *text);
    }
    if (!details.empty()) ToStdout("  {:<28} {}\n", "", details);
    if (!device.profile.empty()) ToStdout("  {:<28} described by {}\n", "", device.profile);
  }
  for (const std::string& note : part.notes) ToStdout("  {}\n", note);
}

int Devices(const DevicesOptions& options) {
  NamedDevices named(options.bench);
  const KnownProfiles known = ProfilesFor(options, named);
  const FoundPart parts[] = {FindCan(options, named, known), FindModbus(options, named), FindHid(known),
                             FindIio(), FindCameras()};
  for (const std::string& trouble : known.troubles) ToStderr("warning: {}\n", trouble);
  if (options.json) {
    nlohmann::ordered_json document;
    for (const FoundPart& part : parts) document[part.kind] = Json(part);
    ToStdout("{}\n", document.dump(2));
  } else {
    for (const FoundPart& part : parts) Print(part);
  }
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddDevices(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "devices",
      "List what is found: nodes on CAN, Modbus units, HID devices, IIO contexts, cameras; each part with "
      "its "
      "reason where there is nothing. Reads alone: nothing is written, nothing moves. On a bus that a "
      "campaign "
      "uses, wait until it is over.\n"
      "Example: strainwave devices bench/examples/in_process.yaml --modbus tcp://192.168.0.10:502");
  auto options = std::make_shared<DevicesOptions>();
  command->add_option("BENCH", options->bench, "bench file (YAML) whose buses and ports are looked at, too");
  command->add_option("--can", options->can, "CAN interface, besides those that the machine shows");
  command->add_option("--modbus", options->modbus,
                      "port to look for Modbus units at: tcp://HOST:PORT or rtu:PATH[:BAUD:8E1]");
  command->add_option("--units", options->units, "Modbus units to ask at those ports: FIRST-LAST or one")
      ->capture_default_str();
  command->add_option("--answer-time", options->answer_ms, "patience with each Modbus unit, in ms")
      ->check(CLI::Range(10, 10'000))
      ->capture_default_str();
  command->add_option(
      "--profiles", options->profiles,
      "folder with profiles of drives and HID devices, in the place of those that come with the program");
  command->add_flag("--json", options->json, "the same as JSON on standard output");
  command->callback([options, &action] { action = [options] { return Devices(*options); }; });
}

}  // namespace strainwave::bench
