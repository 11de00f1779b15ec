// SPDX-License-Identifier: Apache-2.0
// Our drive with a motor that obeys at once, as node 1 on a CAN interface until its input ends: what a master
// that is not ours is tried against (python_can_peer.py).
#include <poll.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <string>

#include "bench/devices/can/socket_can_bus.h"
#include "bench/machines/device_side/drive_on_bus.h"

namespace strainwave::bench {
namespace {

using protocols::canopen::device::DriveCommand;
using protocols::canopen::device::DriveLoop;
using protocols::canopen::device::DriveNode;
using protocols::canopen::device::DrivePhysics;
using protocols::canopen::device::DriveReading;

constexpr double kCycle_s = 0.001;

class ObedientMotor final : public DrivePhysics {
 public:
  DriveReading Read() noexcept override { return reading_; }
  void Command(const DriveCommand& command) noexcept override {
    double speed = 0.0;
    if (command.loop == DriveLoop::kSpeed) speed = command.speed_inc_per_s;
    if (command.loop == DriveLoop::kPosition)
      speed = (command.position_inc - reading_.position_inc) / kCycle_s;
    reading_.speed_inc_per_s = speed;
    reading_.position_inc += speed * kCycle_s;
  }
  void ResetFault() noexcept override {}

 private:
  DriveReading reading_;
};

std::chrono::nanoseconds Now() {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

int Run(const char* interface, const char* eds_path) {
  std::ifstream file(eds_path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  SocketCanSettings settings;
  settings.interface = interface;
  SocketCanBus bus(settings);
  ObedientMotor motor;
  DriveNode node(protocols::canopen::ParseEds(text, eds_path), 1, motor);
  DriveOnBus drive(bus, node);
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (::poll(&input, 1, 1) == 0) drive.Cycle(Now());
  std::printf("received %llu, sent %llu, lost %llu\n", static_cast<unsigned long long>(drive.received()),
              static_cast<unsigned long long>(drive.sent()),
              static_cast<unsigned long long>(bus.lost_frames()));
  return 0;
}

}  // namespace
}  // namespace strainwave::bench

int main(int count, char** arguments) {
  if (count != 3) {
    std::fputs("usage: drive_on_can INTERFACE EDS\n", stderr);
    return 2;
  }
  try {
    return strainwave::bench::Run(arguments[1], arguments[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "drive_on_can: error: %s\n", error.what());
    return 3;
  }
}
