// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <system_error>
#include <vector>

#include "bench/devices/modbus/modbus_transport.h"
#include "protocols/modbus/pdu.h"
#include "tests/fuzz/fed_line.h"

/// Reads and writes of holding registers, one after the other, until the line has no more to say. `check` is
/// given what a good answer must have been, function and data, and the number of the request since the start.
template <typename Check>
void AskUntilItIsSilent(strainwave::bench::ModbusTransport& transport, FedLine& line, Check check) {
  namespace modbus = strainwave::protocols::modbus;
  for (std::uint16_t number = 1; number < 40 && !line.empty(); ++number) {
    try {
      if (!transport.is_open()) transport.Open();
    } catch (const std::system_error&) {
      std::abort();  // a line on which nothing more comes is silent
    }
    const std::uint8_t kind = line.Byte();
    const std::uint16_t count = static_cast<std::uint16_t>(1 + kind % 4);
    std::vector<std::uint16_t> words(count, 0xA5A5);
    const bool writes = kind >= 128;
    const modbus::Pdu request = writes ? modbus::WritePdu(modbus::Table::kHolding, kind, words)
                                       : modbus::ReadPdu(modbus::Table::kHolding, kind, count);
    if (!transport.Ask(request, words, nullptr).good()) continue;
    std::vector<std::uint8_t> answer(request.bytes.begin(), request.bytes.begin() + 5);
    if (!writes) {
      answer = {request.bytes[0], static_cast<std::uint8_t>(2 * count)};
      for (const std::uint16_t word : words) {
        answer.push_back(static_cast<std::uint8_t>(word >> 8));
        answer.push_back(static_cast<std::uint8_t>(word));
      }
    }
    check(answer, number);
  }
}

inline void MustHold(std::span<const std::uint8_t> came, std::span<const std::uint8_t> frame) {
  if (std::search(came.begin(), came.end(), frame.begin(), frame.end()) == came.end()) std::abort();
}
