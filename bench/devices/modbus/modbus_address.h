// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <variant>

#include "bench/devices/modbus/modbus_settings.h"

namespace strainwave::bench {

/// "tcp:HOST:PORT" or "rtu:PATH:BAUD:8E1" (data bits are always 8), "tcp://HOST:PORT" and "rtu:PATH" (19200
/// baud, 8E1, as the standard wants it), too. @throws std::invalid_argument naming what was expected.
std::variant<ModbusTcpPort, ModbusSerialLine> ParseModbusAddress(std::string_view text);

}  // namespace strainwave::bench
