// SPDX-License-Identifier: Apache-2.0
// Any bytes from a Modbus TCP client of the monitor: each answer is a whole frame with the request's number.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "bench/monitor/modbus_server.h"

using namespace strainwave::bench;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Board board({.outputs = {"k1_Nm_per_rad", "k2_Nm_per_rad"}, .coverage = 0.9},
                           [] { return 1; });
  ModbusProtocol protocol(board);
  std::string_view received(reinterpret_cast<const char*>(data), size);
  while (const auto length = protocol.LengthOf(received)) {
    if (*length == 0 || *length > received.size()) std::abort();
    const RequestProtocol::Reply reply = protocol.Answer(received.substr(0, *length), {});
    if (reply.closes) return 0;
    constexpr std::size_t kNumber_bytes = 2;
    constexpr std::size_t kMostAnswer_bytes = 260;
    if (reply.bytes.size() < 9 || reply.bytes.size() > kMostAnswer_bytes ||
        reply.bytes.substr(0, kNumber_bytes) != received.substr(0, kNumber_bytes))
      std::abort();
    received.remove_prefix(*length);
  }
  return 0;
}
