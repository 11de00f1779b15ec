// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "bench/devices/modbus/modbus_settings.h"
#include "protocols/modbus/register_map.h"
#include "tests/bench/modbus/peer_process.h"
#include "tests/bench/real_time.h"
#include "tests/checkout.h"

namespace strainwave::bench {

/// A peer of the folder peers/, and the first line that it says: "port N", "line PATH", or why it cannot.
struct Peer {
  Peer(const std::string& file, const std::vector<std::string>& arguments)
      : process(Command(file, arguments)), hello(process.Line()) {}

  static std::vector<std::string> Command(const std::string& file,
                                          const std::vector<std::string>& arguments) {
    std::vector<std::string> command{"/usr/bin/python3", "-B",
                                     SourceFolder() + "/tests/bench/modbus/peers/" + file};
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
