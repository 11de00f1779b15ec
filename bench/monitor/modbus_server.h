// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/monitor/board.h"
#include "bench/monitor/settings.h"
#include "bench/serving/tcp_server.h"

namespace strainwave::bench {

/// What a PLC is told over Modbus TCP: input registers alone (modbus_registers.h).
class ModbusProtocol : public RequestProtocol {
 public:
  explicit ModbusProtocol(const Board& board) : board_(board) {}
  std::optional<std::size_t> LengthOf(std::string_view received) override;
  Reply Answer(std::string_view request, const Caller& caller) override;

 private:
  const Board& board_;
};

/// Answers Modbus TCP from a thread of its own, as long as it lives.
class ModbusServer {
 public:
  /// @param board  outlives the server.
  /// @throws std::system_error when it cannot listen there.
  ModbusServer(const ListenSettings& settings, const Board& board)
      : protocol_(board), server_("modbus", settings, protocol_) {}

  int port() const { return server_.port(); }

 private:
  ModbusProtocol protocol_;
  TcpServer server_;
};

}  // namespace strainwave::bench
