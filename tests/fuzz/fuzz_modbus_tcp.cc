// SPDX-License-Identifier: Apache-2.0
// Any stream of bytes over a Modbus TCP connection: what is taken for the answer is a whole frame in it, with
// the number of the request and the unit asked.
#include "bench/devices/modbus/modbus_tcp.h"
#include "tests/fuzz/modbus_asking.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::bench;
  FedLine line(std::span(data, size));
  ModbusSettings settings;
  settings.port = ModbusTcpPort{"fed", 502};
  ModbusCounts counts;
  ModbusTcp transport(settings, counts);
  AskUntilItIsSilent(transport, line, [&](std::span<const std::uint8_t> answer, std::uint16_t number) {
    const auto head = strainwave::protocols::modbus::MbapBytes(
        {number, 0, static_cast<std::uint16_t>(1 + answer.size()), static_cast<std::uint8_t>(settings.unit)});
    std::vector<std::uint8_t> frame(head.begin(), head.end());
    frame.insert(frame.end(), answer.begin(), answer.end());
    MustHold(line.came(), frame);
  });
  return 0;
}
