// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "bench/devices/modbus/modbus_transport.h"
#include "protocols/modbus/read_plan.h"
#include "protocols/modbus/write_plan.h"

namespace strainwave::bench {

/// Requests to one device, each asked again when no answer or a wrong one comes, but not for ever: then the
/// connection is closed, and it is for the caller to open it again. Used from one thread, which waits.
class ModbusLink {
 public:
  /// @param wake  calls the thread away from a reading, whose reply is then `kInterrupted`; outlives the
  ///   link; null: nobody does. RTU finishes the answer that it waits for first.
  ModbusLink(ModbusSettings settings, const Wake* wake);
  ModbusLink(const ModbusLink&) = delete;
  ModbusLink& operator=(const ModbusLink&) = delete;

  /// @throws std::system_error naming the port when there is no connection within the answer time.
  void Open() { transport_->Open(); }
  void Close() noexcept { transport_->Close(); }
  bool is_open() const noexcept { return transport_->is_open(); }

  /// @param words  as many as the request counts; filled when the reply is good.
  ModbusReply Read(const protocols::modbus::ReadRequest& request, std::span<std::uint16_t> words);
  /// Not called away from: a stop that has begun is finished.
  ModbusReply Write(const protocols::modbus::WriteRequest& request);
  /// All of them, until one is not good.
  ModbusReply Write(std::span<const protocols::modbus::WriteRequest> requests);
  /// All of them whatever becomes of any, over a new connection where one was lost, and again while one is
  /// not answered: a stop, each part of which counts. After a lost connection it is closed at the end.
  ModbusReply WriteEach(std::span<const protocols::modbus::WriteRequest> requests);
  /// All until one is not good, but called away from like a reading: for what the next writing says anew.
  ModbusReply WriteUnlessCalled(std::span<const protocols::modbus::WriteRequest> requests);

  const ModbusSettings& settings() const { return settings_; }
  const ModbusCounts& counts() const { return counts_; }

 private:
  ModbusReply Ask(const protocols::modbus::Pdu& pdu, std::span<std::uint16_t> words, const Wake* wake);

  ModbusSettings settings_;
  const Wake* wake_;
  ModbusCounts counts_;
  std::unique_ptr<ModbusTransport> transport_;
};

}  // namespace strainwave::bench
