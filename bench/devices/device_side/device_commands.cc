// SPDX-License-Identifier: Apache-2.0
// What a person can have the devices do wrong.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "bench/devices/device_side/device_side_parts.h"

namespace strainwave::bench {

using protocols::canopen::EdsNumber;
using protocols::canopen::SdoAbort;
using Words = std::vector<std::string>;
using FaultKind = ModbusDeviceFault::Kind;

namespace {

std::int64_t NumberIn(const Words& words, std::size_t at, const char* what) {
  const auto number = at < words.size() ? EdsNumber(words[at], 0) : std::nullopt;
  if (!number || *number < 0) throw std::invalid_argument(fmt::format("expected {}", what));
  return *number;
}

// Either side of zero, in the 32 bits that a drive's position has.
std::int32_t CountsIn(const Words& words, std::size_t at) {
  const auto number = at < words.size() ? EdsNumber(words[at], 0) : std::nullopt;
  if (!number || !std::in_range<std::int32_t>(*number))
    throw std::invalid_argument("expected counts from -2147483648 to 2147483647");
  return static_cast<std::int32_t>(*number);
}

double RealIn(const Words& words, std::size_t at, const char* what) {
  double real = 0.0;
  if (at < words.size()) {
    const std::string& word = words[at];
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), real);
    if (error == std::errc() && end == word.data() + word.size() && std::isfinite(real)) return real;
  }
  throw std::invalid_argument(fmt::format("expected {}", what));
}

bool OnOff(const Words& words, std::size_t at) {
  if (at < words.size() && words[at] == "on") return true;
  if (at < words.size() && words[at] == "off") return false;
  throw std::invalid_argument("expected on or off");
}

const std::string& WordIn(const Words& words, std::size_t at, const char* what) {
  if (at >= words.size()) throw std::invalid_argument(fmt::format("expected {}", what));
  return words[at];
}

}  // namespace

const char* DeviceSide::Commands() {
  return R"(drive NODE heartbeat on|off         its sign of life
drive NODE silent on|off            as with the plug pulled
drive NODE reboot                   a dip of its supply
drive NODE emergency CODE           an EMCY message, as in 0x4310
drive NODE sto on|off               safe torque off: on opens the input
drive NODE position COUNTS          its counter is set to this once; nothing moves
drive NODE statusword WORD|off      stuck at this word
drive NODE short-pdo on|off         its PDOs are a byte shorter than mapped
drive NODE abort INDEX SUB on|off   SDO access to an object is refused
drive NODE bus-off on|off           its controller gives up
modbus NAME silence|half|unit|transaction|ok
modbus NAME exception CODE
modbus NAME delay MILLISECONDS
modbus NAME drift REGISTER PER_SECOND
stream NAME drop SAMPLES            lost on the way, as the counter shows
stream NAME silent on|off
sensor freeze|dead CHANNEL|off      repeats its last value; a dead converter stands at its end
sensor drift CHANNEL PER_SECOND     in rad, rad/s, Nm or K
                                    input_angle 0, output_angle 1, input_speed 2, output_torque 3, motor_torque 4,
                                    gear_temperature 5, ambient_temperature 6, vibration 7
gear temperature DEGREES            is set to this once
blank on|off                        the rigid blank in the gear's place)";
}

std::string DeviceSide::Do(const std::string& command) {
  std::istringstream stream(command);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  const std::lock_guard lock(mutex_);
  const std::string& first = WordIn(words, 0, "drive, modbus, stream, sensor, gear or blank");
  if (first == "drive") return DoDrive(words);
  if (first == "modbus") return DoModbus(words);
  if (first == "stream") return DoStream(words);
  if (first == "blank") {
    bench_.MountBlank(OnOff(words, 1));
    return "done";
  }
  if (first == "gear" && WordIn(words, 1, "temperature") == "temperature") {
    Injection heated = injected_;
    heated.gear_temperature_degC = static_cast<double>(NumberIn(words, 2, "a temperature in degC"));
    bench_.Inject(heated);
    return "done";
  }
  if (first == "sensor") {
    const std::string& how = WordIn(words, 1, "freeze, dead or drift");
    const bool off = WordIn(words, 2, "a channel or off") == "off";
    const unsigned bits = off ? 0U : 1U << NumberIn(words, 2, "a channel from 0 to 7 or off");
    if (how == "freeze") {
      injected_ = {.frozen_channels = bits};
    } else if (how == "dead") {
      injected_ = {.dead_channels = bits};
    } else if (how == "drift") {
      injected_ = {.drifting_channels = bits,
                   .drift_per_s = off ? 0.0 : RealIn(words, 3, "an amount a second")};
    } else {
      throw std::invalid_argument("expected freeze, dead or drift");
    }
    bench_.Inject(injected_);
    return "done";
  }
  throw std::invalid_argument("expected drive, modbus, stream, sensor, gear or blank");
}

std::string DeviceSide::DoDrive(const Words& words) {
  const std::int64_t number = NumberIn(words, 1, "a node number");
  const auto found = std::ranges::find(drives_, number, [](const auto& drive) { return drive->node_id; });
  if (found == drives_.end())
    throw std::invalid_argument(fmt::format("expected a drive's node, not {}", number));
  Drive& drive = **found;
  auto& faults = drive.node.faults();
  const std::string& what = WordIn(words, 2, "what the drive is to do");
  if (what == "heartbeat") {
    faults.heartbeat_stops = !OnOff(words, 3);
  } else if (what == "silent") {
    faults.silent = OnOff(words, 3);
  } else if (what == "reboot") {
    drive.node.Reboot();
  } else if (what == "emergency") {
    drive.node.RaiseEmergency(static_cast<std::uint16_t>(NumberIn(words, 3, "an error code")), {});
  } else if (what == "sto") {
    drive.physics.OpenSafeTorqueOff(OnOff(words, 3));
  } else if (what == "position") {
    drive.node.CountFrom(CountsIn(words, 3));
  } else if (what == "bus-off") {
    drive.node.SetBusOff(OnOff(words, 3));
  } else if (what == "statusword") {
    const bool off = WordIn(words, 3, "a word or off") == "off";
    faults.stuck_statusword =
        off ? std::nullopt : std::optional(static_cast<std::uint16_t>(NumberIn(words, 3, "a word or off")));
  } else if (what == "short-pdo") {
    faults.pdo_length_change = OnOff(words, 3) ? -1 : 0;
  } else if (what == "abort") {
    const protocols::canopen::ObjectAddress address{
        static_cast<std::uint16_t>(NumberIn(words, 3, "an index")),
        static_cast<std::uint8_t>(NumberIn(words, 4, "a sub-index"))};
    drive.node.objects().Refuse(address,
                                OnOff(words, 5) ? std::optional(SdoAbort::kHardwareError) : std::nullopt);
  } else {
    throw std::invalid_argument(fmt::format("expected what a drive can do, not {}", what));
  }
  return "done";
}

std::string DeviceSide::DoModbus(const Words& words) {
  const std::string& name = WordIn(words, 1, "the name of a device");
  const auto found = modbus_.find(name);
  if (found == modbus_.end())
    throw std::invalid_argument(fmt::format("expected a Modbus device, not {}", name));
  constexpr std::pair<std::string_view, FaultKind> kKinds[] = {{"ok", FaultKind::kNone},
                                                               {"silence", FaultKind::kSilence},
                                                               {"half", FaultKind::kHalf},
                                                               {"unit", FaultKind::kOtherUnit},
                                                               {"delay", FaultKind::kDelay},
                                                               {"exception", FaultKind::kException},
                                                               {"transaction", FaultKind::kOtherTransaction}};
  const std::string& what = WordIn(words, 2, "what the device is to do");
  if (what == "drift") {
    const auto index = static_cast<std::size_t>(NumberIn(words, 3, "the position of a register"));
    found->second->Drift(index, RealIn(words, 4, "an amount a second"));
    return "done";
  }
  const auto* const kind =
      std::ranges::find_if(kKinds, [&](const auto& known) { return known.first == what; });
  if (kind == std::end(kKinds)) {
    throw std::invalid_argument(fmt::format("expected what a Modbus device can do, not {}", what));
  }
  ModbusDeviceFault fault;
  fault.kind = kind->second;
  if (fault.kind == FaultKind::kException) {
    fault.exception = static_cast<std::uint8_t>(NumberIn(words, 3, "an exception code"));
  }
  if (fault.kind == FaultKind::kDelay) {
    fault.delay = std::chrono::milliseconds(NumberIn(words, 3, "milliseconds"));
  }
  found->second->Set(fault);
  return "done";
}

std::string DeviceSide::DoStream(const Words& words) {
  const std::string& name = WordIn(words, 1, "the name of a stream");
  const auto found = std::ranges::find(streams_, name, [](const auto& stream) { return stream->device; });
  if (found == streams_.end()) throw std::invalid_argument(fmt::format("expected a stream, not {}", name));
  StreamServer& server = *(*found)->server;
  const std::string& what = WordIn(words, 2, "drop or silent");
  if (what == "drop") {
    server.Drop(static_cast<std::uint64_t>(NumberIn(words, 3, "a number of samples")));
  } else if (what == "silent") {
    server.FallSilent(OnOff(words, 3));
  } else {
    throw std::invalid_argument(fmt::format("expected drop or silent, not {}", what));
  }
  return fmt::format("done; dropped so far: {}", server.dropped());
}

}  // namespace strainwave::bench
