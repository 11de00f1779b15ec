// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <modbus.h>

#include <chrono>
#include <cstdint>
#include <memory>

namespace strainwave::bench {

/// A context of libmodbus, closed and freed at its end.
struct CloseModbus {
  void operator()(modbus_t* context) const {
    modbus_close(context);
    modbus_free(context);
  }
};
using ModbusContext = std::unique_ptr<modbus_t, CloseModbus>;

struct ModbusTime {
  std::uint32_t seconds, microseconds;
};
inline ModbusTime ModbusTimeOf(std::chrono::microseconds time) {
  return {static_cast<std::uint32_t>(time.count() / 1'000'000),
          static_cast<std::uint32_t>(time.count() % 1'000'000)};
}

}  // namespace strainwave::bench
