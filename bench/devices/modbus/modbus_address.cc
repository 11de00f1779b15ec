// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_address.h"

#include <charconv>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "bench/devices/tcp_address.h"

namespace strainwave::bench {

std::variant<ModbusTcpPort, ModbusSerialLine> ParseModbusAddress(std::string_view text) {
  constexpr std::string_view kSerial = "rtu:";
  const auto refuse = [&] {
    return std::invalid_argument(
        fmt::format("address = {} (expected tcp:HOST:PORT or rtu:PATH:BAUD:8E1)", text));
  };
  if (!text.starts_with(kSerial)) {
    if (!text.starts_with("tcp:")) throw refuse();
    constexpr std::string_view kUrl = "tcp://";
    const TcpAddress at =
        ParseTcpAddress(text.starts_with(kUrl) ? fmt::format("tcp:{}", text.substr(kUrl.size())) : text);
    return ModbusTcpPort{at.host, at.port};
  }
  const std::string_view rest = text.substr(kSerial.size());
  // A path may have colons itself: /dev/serial/by-path/pci-0000:00:14.0-usb-0:2:1.0.
  const std::size_t frame_at = rest.rfind(':');
  const bool is_path_alone =
      rest.starts_with('/') && (frame_at == std::string_view::npos || rest.size() - frame_at != 4 ||
                                rest[frame_at + 1] < '5' || rest[frame_at + 1] > '9');
  if (is_path_alone) return ModbusSerialLine{.path = std::string(rest)};
  const std::size_t baud_at = frame_at == std::string_view::npos ? frame_at : rest.rfind(':', frame_at - 1);
  if (baud_at == std::string_view::npos || baud_at == 0) throw refuse();
  ModbusSerialLine line;
  line.path = rest.substr(0, baud_at);
  const std::string_view baud = rest.substr(baud_at + 1, frame_at - baud_at - 1);
  const auto [end, error] = std::from_chars(baud.data(), baud.data() + baud.size(), line.baud);
  const std::string_view frame = rest.substr(frame_at + 1);
  const bool is_frame = frame.size() == 3 && frame[0] == '8' &&
                        std::string_view("NEO").find(frame[1]) != std::string_view::npos &&
                        (frame[2] == '1' || frame[2] == '2');
  if (error != std::errc() || end != baud.data() + baud.size() || line.baud <= 0 || !is_frame) throw refuse();
  line.parity = frame[1];
  line.stop_bits = frame[2] - '0';
  return line;
}

}  // namespace strainwave::bench
