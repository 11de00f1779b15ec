// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "bench/devices/modbus/libmodbus.h"
#include "bench/devices/modbus/modbus_transport.h"

namespace strainwave::bench {

/// Modbus TCP. Every request has a number (MBAP transaction): answers with another number came late and are
/// passed over, while the one to this request is still waited for. Another unit is an error. After half an
/// answer, or an envelope that cannot be, nobody knows where the next answer begins: the connection is
/// closed.
///
/// libmodbus makes the connection; frames are taken here, since it neither looks at the unit nor waits on
/// behind a late answer.
class ModbusTcp final : public ModbusTransport {
 public:
  ModbusTcp(const ModbusSettings& settings, ModbusCounts& counts) : settings_(settings), counts_(counts) {}

  void Open() override;
  void Close() noexcept override { context_.reset(); }
  bool is_open() const noexcept override { return context_ != nullptr; }
  ModbusReply Ask(const protocols::modbus::Pdu& pdu, std::span<std::uint16_t> words,
                  const Wake* wake) override;

 private:
  using Deadline = std::chrono::steady_clock::time_point;
  enum class Received { kFrame, kTimeout, kCalled, kGone, kNoFrame };

  bool Send(const protocols::modbus::Pdu& pdu) noexcept;
  Received Receive(Deadline deadline, const Wake* wake) noexcept;
  ModbusReply Distrust(const char* detail);

  const ModbusSettings& settings_;
  ModbusCounts& counts_;
  ModbusContext context_;
  int socket_{-1};
  std::uint16_t transaction_{};  // of the present request
  std::uint32_t asked_{};        // over this connection, as far back as an answer may be late
  std::array<std::uint8_t, protocols::modbus::kLongestTcpFrame> frame_{};  // that comes in
  std::size_t received_{};                                                 // of it
  std::size_t length_{};                                                   // of the whole frame in `frame_`
};

}  // namespace strainwave::bench
