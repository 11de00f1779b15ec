// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "bench/devices/modbus/modbus_reply.h"
#include "bench/devices/modbus/modbus_settings.h"
#include "bench/devices/wake.h"
#include "protocols/modbus/pdu.h"

namespace strainwave::bench {

/// One connection over which one request at a time is asked, from one thread, which waits. An answer to
/// another request is never taken for that to the present one.
class ModbusTransport {
 public:
  ModbusTransport() = default;
  ModbusTransport(const ModbusTransport&) = delete;
  ModbusTransport& operator=(const ModbusTransport&) = delete;
  virtual ~ModbusTransport() = default;

  /// @throws std::system_error naming the port when there is no connection within the answer time.
  virtual void Open() = 0;
  virtual void Close() noexcept = 0;
  virtual bool is_open() const noexcept = 0;

  /// Asks once. A connection that can no longer be trusted is closed.
  /// @param words  as many as the request counts; filled when the reply is good.
  /// @param wake   ends the waiting, where the transport allows it; null: nothing does.
  virtual ModbusReply Ask(const protocols::modbus::Pdu& pdu, std::span<std::uint16_t> words,
                          const Wake* wake) = 0;
};

/// Compares an answer, without its envelope, with its request, and counts what it is.
ModbusReply ReplyOf(const protocols::modbus::Pdu& request, std::span<const std::uint8_t> answer,
                    std::span<std::uint16_t> words, ModbusCounts& counts);
ModbusReply WrongAnswer(const char* detail, ModbusCounts& counts);

/// @param settings, counts  outlive the transport.
std::unique_ptr<ModbusTransport> MakeTransport(const ModbusSettings& settings, ModbusCounts& counts);

}  // namespace strainwave::bench
