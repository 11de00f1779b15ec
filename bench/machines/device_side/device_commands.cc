// SPDX-License-Identifier: Apache-2.0
// What a person can have the devices do wrong.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/machines/device_side/device_side_parts.h"

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
  return R"(drive NODE|NAME sto on|off          on opens safe torque off; on Modbus the enable input
drive NODE|NAME reboot              a dip of its supply
drive NODE|NAME statusword WORD|off stuck at this word
drive NODE|NAME torque-limit NM|off gives no more, and says nothing of it; at the servo's shaft
drive NODE|NAME speed-limit RPM|off the same; in rpm
drive NODE heartbeat on|off         its sign of life
drive NODE silent on|off            as with the plug pulled
drive NODE emergency CODE           an EMCY message, as in 0x4310
drive NODE position COUNTS          its counter is set to this once; nothing moves
drive NODE short-pdo on|off         its PDOs are a byte shorter than mapped
drive NODE abort INDEX SUB on|off   SDO access to an object is refused
drive NODE bus-off on|off           its controller gives up
drive NAME fault                    is in fault
drive NAME count-stuck on|off       its watchdog register reads what it read before
drive NAME brake-inverted on|off    its brake reads back as the opposite
drive NAME actual-stuck on|off      its speed, torque and position read what they read before
modbus NAME silence|unplugged|half|unit|transaction|ok
                                    unplugged: hears nothing either
modbus NAME reset                   of its TCP connections
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
blank on|off                        the rigid blank in the gear's place
load served                         for how long the shafts turned under the load that was asked for)";
}

std::string DeviceSide::Do(const std::string& command) {
  std::istringstream stream(command);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  const std::lock_guard lock(mutex_);
  const std::string& first = WordIn(words, 0, "drive, modbus, stream, sensor, gear, blank or load");
  if (first == "drive") return DoDrive(words);
  if (first == "modbus") return DoModbus(words);
  if (first == "stream") return DoStream(words);
  if (first == "blank") {
    bench_.MountBlank(OnOff(words, 1));
    return "done";
  }
  if (first == "load" && WordIn(words, 1, "served") == "served") {
    return fmt::format("served {:.3f} s under load", served_.served_s());
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
  throw std::invalid_argument("expected drive, modbus, stream, sensor, gear, blank or load");
}

std::string DeviceSide::DoDrive(const Words& words) {
  const std::string& name = WordIn(words, 1, "a drive's node or name");
  const auto found = std::ranges::find(drives_, name, [](const auto& drive) { return drive->name; });
  if (found == drives_.end())
    throw std::invalid_argument(fmt::format("expected a drive's node or name, not {}", name));
  Drive& drive = **found;
  const std::string& what = WordIn(words, 2, "what the drive is to do");
  const auto limit = [&](const char* expected) {
    const bool off = WordIn(words, 3, expected) == "off";
    return off ? std::numeric_limits<double>::infinity() : RealIn(words, 3, expected);
  };
  if (what == "torque-limit") {
    drive.servo.LimitTorque(limit("a torque in Nm or off"));
    return "done";
  }
  if (what == "speed-limit") {
    drive.servo.LimitSpeed(RadPerSFromRpm(limit("a speed in rpm or off")));
    return "done";
  }
  return drive.canopen ? DoCanopenDrive(drive, words) : DoModbusDrive(drive, words);
}

std::string DeviceSide::DoCanopenDrive(Drive& drive, const Words& words) {
  auto& node = drive.canopen->node;
  auto& faults = node.faults();
  const std::string& what = words[2];
  if (what == "heartbeat") {
    faults.heartbeat_stops = !OnOff(words, 3);
  } else if (what == "silent") {
    faults.silent = OnOff(words, 3);
  } else if (what == "reboot") {
    node.Reboot();
  } else if (what == "emergency") {
    node.RaiseEmergency(static_cast<std::uint16_t>(NumberIn(words, 3, "an error code")), {});
  } else if (what == "sto") {
    drive.canopen->physics.OpenSafeTorqueOff(OnOff(words, 3));
  } else if (what == "position") {
    node.CountFrom(CountsIn(words, 3));
  } else if (what == "bus-off") {
    node.SetBusOff(OnOff(words, 3));
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
    node.objects().Refuse(address, OnOff(words, 5) ? std::optional(SdoAbort::kHardwareError) : std::nullopt);
  } else {
    throw std::invalid_argument(fmt::format("expected what a drive on CAN can do, not {}", what));
  }
  return "done";
}

std::string DeviceSide::DoModbusDrive(Drive& drive, const Words& words) {
  ModbusServoModel::Faults faults = drive.modbus->faults();
  const std::string& what = words[2];
  if (what == "fault") {
    drive.modbus->Fault();
  } else if (what == "reboot") {
    drive.modbus->Restart();
    modbus_.at(drive.name)->ResetConnections();
  } else if (what == "sto") {
    faults.enable_input_open = OnOff(words, 3);
  } else if (what == "statusword") {
    const bool off = WordIn(words, 3, "a word or off") == "off";
    faults.stuck_status = off ? std::nullopt : std::optional(RealIn(words, 3, "a word or off"));
  } else if (what == "count-stuck") {
    faults.count_stuck = OnOff(words, 3);
  } else if (what == "brake-inverted") {
    faults.brake_inverted = OnOff(words, 3);
  } else if (what == "actual-stuck") {
    faults.actual_stuck = OnOff(words, 3);
  } else {
    throw std::invalid_argument(fmt::format("expected what a drive on Modbus can do, not {}", what));
  }
  drive.modbus->set_faults(faults);
  return "done";
}

std::string DeviceSide::DoModbus(const Words& words) {
  const std::string& name = WordIn(words, 1, "the name of a device");
  const auto found = modbus_.find(name);
  if (found == modbus_.end())
    throw std::invalid_argument(fmt::format("expected a Modbus device, not {}", name));
  constexpr std::pair<std::string_view, FaultKind> kKinds[] = {{"ok", FaultKind::kNone},
                                                               {"silence", FaultKind::kSilence},
                                                               {"unplugged", FaultKind::kUnplugged},
                                                               {"half", FaultKind::kHalf},
                                                               {"unit", FaultKind::kOtherUnit},
                                                               {"delay", FaultKind::kDelay},
                                                               {"exception", FaultKind::kException},
                                                               {"transaction", FaultKind::kOtherTransaction}};
  const std::string& what = WordIn(words, 2, "what the device is to do");
  if (what == "reset") {
    found->second->ResetConnections();
    return "done";
  }
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
