// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "bench/devices/modbus/modbus_settings.h"

namespace strainwave::bench {

/// What became of a request.
struct ModbusReply {
  enum class Outcome : std::uint8_t {
    kGood,
    kException,     // the device refused, with `exception`
    kTimeout,       // no answer, as often as it was asked
    kWrongAnswer,   // answers came, none to what was asked
    kInterrupted,   // the caller was called away; what was asked does not matter any more
    kDisconnected,  // the connection went, or there is none
  };
  Outcome outcome{Outcome::kGood};
  std::uint8_t exception{};
  const char* detail{""};  // what was wrong with the answer

  bool good() const { return outcome == Outcome::kGood; }
};

/// "no answer within 500 ms, asked 3 times", for people.
std::string Words(const ModbusReply& reply, const ModbusSettings& settings);

/// What a connection has seen; read from any thread.
struct ModbusCounts {
  std::atomic<std::uint64_t> requests{};
  std::atomic<std::uint64_t> exceptions{};
  std::atomic<std::uint64_t> timeouts{};
  std::atomic<std::uint64_t> wrong_answers{};
  std::atomic<std::uint64_t> late_answers{};  // to an older request, passed over
  std::atomic<std::uint64_t> connections{};
};

}  // namespace strainwave::bench
