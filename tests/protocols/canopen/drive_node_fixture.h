// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "protocols/canopen/drive_node.h"
#include "tests/checkout.h"
#include "tests/protocols/canopen/frames_by_hand.h"

namespace strainwave::protocols::canopen::device {

inline const EdsFile& DriveEds() {
  static const EdsFile eds = [] {
    const std::string path = SourceFolder() + "/bench/devices/profiles/strainwave_drive.eds";
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    return ParseEds(text, path);
  }();
  return eds;
}

/// A motor that does at once what it is asked for, unless it is stuck.
class ObedientMotor final : public DrivePhysics {
 public:
  DriveReading Read() noexcept override { return reading; }
  void Command(const DriveCommand& next) noexcept override { command = next; }
  void ResetFault() noexcept override { ++resets; }

  void Step(double dt_s) {
    double speed = 0.0;
    if (command.loop == DriveLoop::kSpeed) speed = command.speed_inc_per_s;
    if (command.loop == DriveLoop::kPosition) speed = (command.position_inc - reading.position_inc) / dt_s;
    if (command.loop == DriveLoop::kTorque) speed = reading.speed_inc_per_s;
    reading.speed_inc_per_s = stuck ? 0.0 : speed;
    reading.position_inc += reading.speed_inc_per_s * dt_s;
    reading.torque_permille = command.loop == DriveLoop::kTorque ? command.torque_permille : 0.0;
  }

  DriveCommand command;
  DriveReading reading;
  bool stuck{};
  int resets{};
};

/// Node 1 of our own drive, in cycles of 1 ms.
class DriveNodeTest : public testing::Test {
 protected:
  static constexpr double kTurn = 65536.0;  // position units and increments

  explicit DriveNodeTest(const EdsFile& eds = DriveEds()) : node(eds, 1, motor) {}

  /// What the node says to this frame, before its next cycle.
  std::string Give(std::string_view frame) {
    node.OnFrame(ByHand(frame), now);
    return AllOf(node);
  }
  /// `cycles` milliseconds; what the node says meanwhile.
  std::string Run(int cycles = 1) {
    std::string all;
    for (int i = 0; i < cycles; ++i) {
      now += std::chrono::milliseconds(1);
      node.Poll(now);
      motor.Step(0.001);
      const std::string said = AllOf(node);
      if (!said.empty()) all += (all.empty() ? "" : "\n") + said;
    }
    return all;
  }
  void BootUp() { Run(); }
  void Start() {
    BootUp();
    Give("000#01 01");
    Run();
  }
  /// Writes through the dictionary as SDO does; the reason when refused.
  std::optional<SdoAbort> Set(std::uint16_t index, std::uint8_t subindex, std::int64_t value) {
    const ObjectAddress address{index, subindex};
    std::vector<std::uint8_t> bytes(node.objects().At(address).size());
    for (std::uint8_t& byte : bytes) {
      byte = static_cast<std::uint8_t>(value & 0xFF);
      value >>= 8;
    }
    return node.objects().Write(address, bytes);
  }
  std::int64_t Get(std::uint16_t index, std::uint8_t subindex = 0) {
    return node.objects().At({index, subindex}).integer();
  }
  /// By RPDO 1, the controlword alone.
  std::string Control(unsigned word) {
    CanFrame frame = ByHand("201#00 00");
    frame.data[0] = static_cast<std::uint8_t>(word & 0xFF);
    frame.data[1] = static_cast<std::uint8_t>(word >> 8);
    node.OnFrame(frame, now);
    return Run();
  }
  void Enable(int mode) {
    ASSERT_EQ(Set(0x6060, 0, mode), std::nullopt);
    for (const unsigned word : {0x06U, 0x07U, 0x0FU}) Control(word);
    ASSERT_EQ(node.power_state(), PowerState::kOperationEnabled);
  }

  ObedientMotor motor;
  DriveNode node;
  std::chrono::nanoseconds now{};
};

}  // namespace strainwave::protocols::canopen::device
