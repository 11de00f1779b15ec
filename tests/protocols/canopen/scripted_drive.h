// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "protocols/canopen/drive_master.h"
#include "tests/protocols/canopen/frames.h"

namespace strainwave::protocols::canopen {

/// A profile of an invented drive: 4096 counts a turn, rpm, 1 N·m rated, so that numbers are easy.
inline DriveProfile EasyProfile() {
  using enum OperationMode;
  DriveProfile profile;
  profile.name = "easy drive";
  profile.identity = {.vendor = 0x29C, .product = 0x17, .revision = 0};
  profile.modes = {kProfileVelocity, kProfilePosition, kProfileTorque, kCyclicPosition,
                   kCyclicVelocity,  kCyclicTorque,    kHoming};
  profile.units = {.position_counts_per_rev = 4096.0,
                   .velocity_units_per_rpm = 1.0,
                   .acceleration_units_per_rpm_per_s = 1.0,
                   .rated_torque_Nm = 1.0,
                   .gear_ratio = 1.0,
                   .sign = 1};
  profile.limits = {.max_speed_rad_per_s = 314.159265,
                    .max_torque_Nm = 2.0,
                    .acceleration_rad_per_s2 = 1000.0,
                    .quick_stop_deceleration_rad_per_s2 = 5000.0,
                    .following_error_window_rad = 0.5,
                    .following_error_time_ms = 10,
                    .standstill_speed_rad_per_s = 0.5};
  profile.brake = {.by = BrakeControl::By::kDigitalOutput, .mask = 0x1};
  return profile;
}

/// The least of a drive that a master can be tried on: an SDO server for numbers, the power states, and PDOs
/// in the layout of StandardPdos, packed by hand.
class ScriptedDrive {
 public:
  explicit ScriptedDrive(std::uint32_t node = 3) : node_(node) {
    objects[{0x1000, 0}] = 0x00020192;
    objects[{0x1014, 0}] = 0x80 + node;
    objects[{0x1018, 1}] = 0x29C;
    objects[{0x1018, 2}] = 0x17;
    objects[{0x1018, 3}] = 0x10002;
    objects[{0x6502, 0}] = 0x3AD;  // PP, PV, TQ, homing, CSP, CSV, CST
    objects[{0x6076, 0}] = 1000;   // mN·m
    for (std::uint16_t i = 0; i < 3; ++i) {
      objects[{static_cast<std::uint16_t>(0x1400 + i), 1}] = 0x200 + 0x100 * i + node;
      objects[{static_cast<std::uint16_t>(0x1800 + i), 1}] = 0x40000180 + 0x100 * i + node;
    }
  }

  std::map<ObjectAddress, std::uint32_t> objects;
  std::set<ObjectAddress> ignores_writes;  // acknowledged, but not taken
  std::set<ObjectAddress> unknown;
  std::vector<ObjectAddress> written;
  std::vector<std::string> nmt;
  bool is_operational = false;
  bool is_dead = false;

  PowerState power = PowerState::kSwitchOnDisabled;
  std::uint16_t mode_bits = 0x0200;  // of the statusword, beside the power state
  std::int8_t mode_display = 0;
  bool confirms_mode = true;
  bool takes_commands = true;
  std::uint16_t error_code = 0;
  std::int32_t position = 0;
  std::int32_t velocity = 0;
  std::int16_t torque = 0;

  std::uint16_t controlword = 0;
  std::int32_t target_position = 0;
  std::int32_t target_velocity = 0;
  std::int16_t target_torque = 0;
  std::uint32_t digital_outputs = 0;

  std::uint16_t statusword() const {
    constexpr std::uint16_t kPatterns[] = {0x00, 0x40, 0x21, 0x23, 0x27, 0x07, 0x0F, 0x08};
    return static_cast<std::uint16_t>(mode_bits | kPatterns[static_cast<int>(power)]);
  }

  void OnFrame(const CanFrame& frame) {
    if (frame.id == 0x000) OnNmt(frame);
    if (frame.id == 0x600 + node_ && !is_dead) OnSdo(frame);
    if (!is_operational) return;
    const auto& d = frame.data;
    if (frame.id == 0x200 + node_ && frame.length == 3) OnControl(Word(d[0], d[1]), d[2]);
    if (frame.id == 0x300 + node_ && frame.length == 8) {
      target_position = static_cast<std::int32_t>(Long(d[0], d[1], d[2], d[3]));
      target_velocity = static_cast<std::int32_t>(Long(d[4], d[5], d[6], d[7]));
    }
    if (frame.id == 0x400 + node_ && frame.length == 6) {
      target_torque = static_cast<std::int16_t>(Word(d[0], d[1]));
      digital_outputs = Long(d[2], d[3], d[4], d[5]);
    }
  }

  CanFrame Status() const {
    const std::uint16_t word = statusword();
    return {.id = 0x180 + node_,
            .length = 5,
            .data = {Byte(word, 0), Byte(word, 1), static_cast<std::uint8_t>(mode_display),
                     Byte(error_code, 0), Byte(error_code, 1)}};
  }
  CanFrame Motion() const {
    const auto p = static_cast<std::uint32_t>(position);
    const auto v = static_cast<std::uint32_t>(velocity);
    return {.id = 0x280 + node_,
            .length = 8,
            .data = {Byte(p, 0), Byte(p, 1), Byte(p, 2), Byte(p, 3), Byte(v, 0), Byte(v, 1), Byte(v, 2),
                     Byte(v, 3)}};
  }
  CanFrame Torque() const {
    const auto t = static_cast<std::uint16_t>(torque);
    return {.id = 0x380 + node_, .length = 2, .data = {Byte(t, 0), Byte(t, 1)}};
  }
  CanFrame Heartbeat() const {
    return {
        .id = 0x700 + node_, .length = 1, .data = {static_cast<std::uint8_t>(is_operational ? 0x05 : 0x7F)}};
  }

  std::deque<CanFrame> answers;  // of the SDO server

 private:
  static std::uint16_t Word(unsigned low, unsigned high) {
    return static_cast<std::uint16_t>(low | high << 8);
  }
  static std::uint32_t Long(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    return a | b << 8 | c << 16 | d << 24;
  }
  static std::uint8_t Byte(std::uint32_t value, int which) {
    return static_cast<std::uint8_t>(value >> (8 * which));
  }

  void OnNmt(const CanFrame& frame) {
    nmt.push_back(Text(frame));
    if (frame.data[1] != node_) return;
    if (frame.data[0] == 0x01) is_operational = true;
    if (frame.data[0] == 0x80) is_operational = false;
  }

  void OnControl(std::uint16_t word, std::uint8_t mode) {
    if (confirms_mode) mode_display = static_cast<std::int8_t>(mode);
    if (takes_commands) power = NextPowerState(power, controlword, word);
    controlword = word;
  }

  // Length by index, as the standard has it.
  static unsigned Bytes(ObjectAddress address) {
    switch (address.index) {
      case 0x1029:
      case 0x60C2:
        return 1;
      case 0x1017:
      case 0x6007:
      case 0x605A:
      case 0x605B:
      case 0x605C:
      case 0x605D:
      case 0x605E:
      case 0x6066:
      case 0x6072:
        return 2;
      default:
        break;
    }
    const unsigned area = address.index & 0xFF00U;
    if (area == 0x1400 || area == 0x1800) return address.subindex == 1 ? 4 : address.subindex == 2 ? 1 : 2;
    if (area == 0x1600 || area == 0x1A00) return address.subindex == 0 ? 1 : 4;
    return 4;
  }

  void OnSdo(const CanFrame& frame) {
    const auto& d = frame.data;
    const ObjectAddress address{Word(d[1], d[2]), d[3]};
    CanFrame answer{.id = 0x580 + node_, .length = 8, .data = {0, d[1], d[2], d[3]}};
    if (unknown.contains(address)) {
      answer.data = {0x80, d[1], d[2], d[3], 0x00, 0x00, 0x02, 0x06};
    } else if (d[0] == 0x40) {
      const unsigned bytes = Bytes(address);
      const std::uint32_t value = objects[address];
      answer.data[0] = static_cast<std::uint8_t>(0x43 | (4 - bytes) << 2);
      for (unsigned i = 0; i < bytes; ++i) answer.data[4 + i] = Byte(value, static_cast<int>(i));
    } else if ((d[0] & 0xE3) == 0x23) {
      answer.data[0] = 0x60;
      written.push_back(address);
      if (!ignores_writes.contains(address)) objects[address] = Long(d[4], d[5], d[6], d[7]);
    } else {
      return;  // an abort
    }
    answers.push_back(answer);
  }

  std::uint32_t node_;
};

/// Master and drive on one wire, in cycles of 4 ms; every frame of the master is kept as text.
class DriveBench {
 public:
  explicit DriveBench(const DriveProfile& profile = EasyProfile()) : master(profile, 3) {}

  ScriptedDrive drive;
  DriveMaster master;
  std::chrono::nanoseconds now{std::chrono::seconds(100)};
  std::vector<std::string> sent;
  bool sends_pdos = true;
  bool sends_heartbeats = true;

  void Hear(const CanFrame& frame) { master.OnFrame(frame, now); }
  void Hear(const std::string& frame) { Hear(Frame(frame)); }

  void Cycle(std::chrono::nanoseconds period = std::chrono::milliseconds(4)) {
    now += period;
    if (cycles_++ % 10 == 0 && sends_heartbeats) Hear(drive.Heartbeat());
    if (drive.is_operational && sends_pdos) {
      Hear(drive.Status());
      Hear(drive.Motion());
      Hear(drive.Torque());
    }
    master.OnSync(now);
    master.Poll(now);
    Deliver();
  }

  /// The master's frames to the drive, and its answers back, until there are none.
  void Deliver() {
    for (int i = 0; i < 10000; ++i) {
      if (const auto frame = master.NextFrame(now)) {
        sent.push_back(Text(*frame));
        drive.OnFrame(*frame);
      } else if (!drive.answers.empty()) {
        const CanFrame answer = drive.answers.front();
        drive.answers.pop_front();
        master.OnFrame(answer, now);
      } else {
        return;
      }
    }
  }

  bool CycleUntil(DriveStage stage, int most = 1000) {
    for (int i = 0; i < most && master.stage() != stage; ++i) Cycle();
    return master.stage() == stage;
  }

  bool BringUp() {
    return master.Commission(now) == DriveAnswer::kAccepted && CycleUntil(DriveStage::kDisabled);
  }
  bool BringUp(OperationMode mode) {
    return BringUp() && master.Enable(mode, now) == DriveAnswer::kAccepted &&
           CycleUntil(DriveStage::kEnabled);
  }

  /// Frames of the master under one identifier since the last call of Forget.
  std::vector<std::string> SentTo(const std::string& id) const {
    std::vector<std::string> found;
    for (const std::string& text : sent) {
      if (text.starts_with(id + "#")) found.push_back(text.substr(4));
    }
    return found;
  }
  void Forget() { sent.clear(); }

 private:
  int cycles_ = 0;
};

}  // namespace strainwave::protocols::canopen
