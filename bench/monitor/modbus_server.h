// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "bench/monitor/board.h"
#include "bench/monitor/settings.h"

namespace strainwave::bench {

/// Answers Modbus TCP from a thread of its own, as long as it lives: input registers alone
/// (modbus_registers.h), to eight clients at a time.
class ModbusServer {
 public:
  /// @param board  outlives the server.
  /// @throws std::system_error when it cannot listen there.
  ModbusServer(const ListenSettings& settings, const Board& board);
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;
  ~ModbusServer();

  int port() const { return port_; }

 private:
  struct Context;
  void Serve();

  const Board& board_;
  std::unique_ptr<Context> context_;
  int listener_{-1};
  int port_{};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace strainwave::bench
