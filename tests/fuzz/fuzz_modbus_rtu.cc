// SPDX-License-Identifier: Apache-2.0
// Any bytes on a serial line after each request, with a right checksum or none: what is taken for the answer
// is a whole frame of the unit asked, with its checksum, that came after the request.
#include "bench/devices/modbus/modbus_rtu.h"
#include "tests/fuzz/modbus_asking.h"

namespace {

using namespace strainwave::bench;

constexpr int kUnit = 1;

void AddChecksum(std::vector<std::uint8_t>& frame) {
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t byte : frame) {
    crc = static_cast<std::uint16_t>(crc ^ byte);
    for (int bit = 0; bit < 8; ++bit) {
      crc = static_cast<std::uint16_t>((crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1);
    }
  }
  frame.push_back(static_cast<std::uint8_t>(crc));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
}

class SerialLine final : public FedLine {
 public:
  using FedLine::FedLine;
  void Complete(std::vector<std::uint8_t>& part, bool is_right) override {
    if (is_right) AddChecksum(part);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  SerialLine line(std::span(data, size));
  ModbusSettings settings;
  ModbusSerialLine port;
  port.path = "fed";
  port.answers_echo = line.Byte() % 2 == 0;
  settings.port = port;
  settings.unit = kUnit;
  ModbusCounts counts;
  ModbusRtu transport(settings, counts);
  AskUntilItIsSilent(transport, line, [&](std::span<const std::uint8_t> answer, std::uint16_t) {
    std::vector<std::uint8_t> frame{kUnit};
    frame.insert(frame.end(), answer.begin(), answer.end());
    AddChecksum(frame);
    MustHold(line.came_last(), frame);
  });
  return 0;
}
