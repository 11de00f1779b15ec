// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "bench/roles/servo_drive.h"

namespace strainwave::bench {

/// Notes what it is asked for.
class NotingServo final : public ServoDrive {
 public:
  void Enable(DriveMode mode) noexcept override {
    constexpr std::string_view kNames[] = {"enable speed", "enable position", "enable torque"};
    notes.push_back(kNames[static_cast<std::size_t>(mode)]);
  }
  void Disable() noexcept override { notes.push_back("disable"); }
  void QuickStop() noexcept override { notes.push_back("quick stop"); }
  void ResetFault() noexcept override { notes.push_back("reset"); }
  void SetBrake(bool engaged) noexcept override {
    actual.brake_engaged = engaged;
    notes.push_back(engaged ? std::string_view("brake on") : std::string_view("brake off"));
  }
  void CommandSpeed(double value) noexcept override { set_point = value; }
  void CommandPosition(double value) noexcept override { set_point = value; }
  void CommandTorque(double value) noexcept override { set_point = value; }
  DriveActual Actual() const noexcept override { return actual; }

  std::vector<std::string_view> TakeNotes() { return std::exchange(notes, {}); }

  std::vector<std::string_view> notes;
  double set_point{};
  DriveActual actual;
};
using Notes = std::vector<std::string_view>;

}  // namespace strainwave::bench
