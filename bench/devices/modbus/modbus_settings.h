// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <variant>

namespace strainwave::bench {

struct ModbusTcpPort {
  std::string host;
  int port{502};
};

struct ModbusSerialLine {
  std::string path;  // "/dev/ttyUSB0"
  int baud{19'200};
  char parity{'E'};  // N, E or O
  int stop_bits{1};
  bool answers_echo{true};  // function 8, if only with "illegal function"; false: it ignores what it lacks
};

/// How one device is reached, and how patient its client is.
struct ModbusSettings {
  std::variant<ModbusTcpPort, ModbusSerialLine> port;
  int unit{1};
  std::chrono::milliseconds answer_time{500};  // for one answer; too short a time costs answers that were due
  int retries{2};                              // of one request, before the connection is given up
  std::chrono::milliseconds first_pause{100};  // before it is tried again; twice as long each time, up to
  std::chrono::milliseconds longest_pause{5000};
};

}  // namespace strainwave::bench
