// SPDX-License-Identifier: Apache-2.0
// Any traffic at our own drive: whatever comes, it answers in frames of eight bytes at most, commands finite
// numbers, and gives its motor no torque in a state without power.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "protocols/canopen/drive_node.h"

namespace {

using namespace strainwave::protocols;
using namespace strainwave::protocols::canopen;

class Motor final : public device::DrivePhysics {
 public:
  device::DriveReading Read() noexcept override { return reading; }
  void Command(const device::DriveCommand& next) noexcept override { command = next; }
  void ResetFault() noexcept override {}

  device::DriveCommand command;
  device::DriveReading reading;
};

// Read where the fuzzer is started, as run.sh does, at the top of the tree.
EdsFile OwnEds() {
  const char* path = "bench/devices/profiles/strainwave_drive.eds";
  std::ifstream file(path, std::ios::binary);
  return ParseEds(std::string{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()}, path);
}

bool HasPower(PowerState state) {
  return state == PowerState::kOperationEnabled || state == PowerState::kQuickStopActive ||
         state == PowerState::kFaultReactionActive;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint32_t kIds[] = {0x000, 0x080, 0x201, 0x301, 0x401, 0x501, 0x601, 0x77F};
  constexpr std::size_t kRecord = 10;  // which id and flags, length and cycles, data
  static const EdsFile eds = OwnEds();
  static Motor motor;
  static device::DriveNode node(eds, 1, motor);
  static std::chrono::nanoseconds now{};
  motor.reading = {};
  node.Reboot();
  for (std::size_t at = 0; at + kRecord <= size; at += kRecord) {
    CanFrame frame;
    frame.id = kIds[data[at] & 7];
    frame.remote = (data[at] & 0xF8) == 0xF8;
    frame.length = static_cast<std::uint8_t>(std::min(data[at + 1] & 15, 8));
    std::copy_n(data + at + 2, frame.length, frame.data.begin());
    node.OnFrame(frame, now);
    motor.reading.safe_torque_off = (data[at] & 0xF8) == 0xF0;
    for (int cycle = data[at + 1] >> 4; cycle >= 0; --cycle) {
      now += std::chrono::milliseconds(1);
      node.Poll(now);
      CanFrame answer;
      for (int i = 0; node.Next(answer); ++i) {
        // A block of 127 segments, and all PDOs.
        if (answer.length > 8 || i > 200) std::abort();
      }
      const device::DriveCommand& command = motor.command;
      if (!std::isfinite(command.position_inc) || !std::isfinite(command.speed_inc_per_s) ||
          !std::isfinite(command.torque_permille)) {
        std::abort();
      }
      if (command.loop != device::DriveLoop::kOff && !HasPower(node.power_state())) std::abort();
      if (command.loop == device::DriveLoop::kPosition) motor.reading.position_inc = command.position_inc;
      if (command.loop == device::DriveLoop::kSpeed) motor.reading.speed_inc_per_s = command.speed_inc_per_s;
    }
  }
  return 0;
}
