// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "bench/monitor/board.h"
#include "bench/monitor/settings.h"

namespace strainwave::bench {

/// Serves `/metrics` over HTTP from threads of its own, as long as it lives.
class PrometheusServer {
 public:
  /// @param board  outlives the server.
  /// @throws std::system_error when it cannot listen there.
  PrometheusServer(const ListenSettings& settings, const Board& board);
  PrometheusServer(const PrometheusServer&) = delete;
  PrometheusServer& operator=(const PrometheusServer&) = delete;
  ~PrometheusServer();

  int port() const { return port_; }

 private:
  struct Server;
  std::unique_ptr<Server> server_;
  int port_{};
};

}  // namespace strainwave::bench
