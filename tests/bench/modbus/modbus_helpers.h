// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "bench/devices/modbus/modbus_settings.h"
#include "bench/roles/bench_clock.h"
#include "protocols/modbus/register_map.h"
#include "tests/bench/modbus/peer_process.h"

namespace strainwave::bench {

/// The clock of a real bench, since the test began.
class SteadyBenchClock final : public BenchClock {
 public:
  std::chrono::nanoseconds Now() const noexcept override { return std::chrono::steady_clock::now() - start_; }
  void SleepUntil(std::chrono::nanoseconds time) noexcept override {
    std::this_thread::sleep_until(start_ + time);
  }
  std::uint64_t Overruns() const noexcept override { return 0; }

 private:
  std::chrono::steady_clock::time_point start_{std::chrono::steady_clock::now()};
};

/// Waits for an event, and never for a time.
bool Until(auto&& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

/// A peer of the folder peers/, and the first line that it says: "port N", "line PATH", or why it cannot.
struct Peer {
  Peer(const std::string& file, const std::vector<std::string>& arguments)
      : process(Command(file, arguments)), hello(process.Line()) {}

  static std::vector<std::string> Command(const std::string& file,
                                          const std::vector<std::string>& arguments) {
    std::vector<std::string> command{"/usr/bin/python3", "-B",
                                     STRAINWAVE_SOURCE_DIR "/tests/bench/modbus/peers/" + file};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
  }

  bool is_there() const { return hello.starts_with("port ") || hello.starts_with("line "); }

  ModbusSettings Settings() const {
    ModbusSettings settings;
    const std::string at = hello.substr(5);
    if (hello.starts_with("port ")) {
      settings.port = ModbusTcpPort{"127.0.0.1", std::stoi(at)};
    } else {
      settings.port = ModbusSerialLine{at};
    }
    settings.first_pause = std::chrono::milliseconds(10);
    return settings;
  }

  PeerProcess process;
  std::string hello;
};

inline protocols::modbus::Register Named(const char* name, int address) {
  protocols::modbus::Register value;
  value.name = name;
  value.address = static_cast<std::uint16_t>(address);
  return value;
}

}  // namespace strainwave::bench
