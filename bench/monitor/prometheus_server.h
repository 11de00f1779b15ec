// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "bench/monitor/board.h"
#include "bench/monitor/settings.h"
#include "bench/serving/tcp_server.h"

namespace strainwave::bench {

/// Serves `/metrics` over HTTP from a thread of its own, as long as it lives; a connection for each page.
class PrometheusServer {
 public:
  /// @param board  outlives the server.
  /// @throws std::system_error when it cannot listen there.
  PrometheusServer(const ListenSettings& settings, const Board& board);
  ~PrometheusServer();

  int port() const { return server_.port(); }

 private:
  class Pages;
  std::unique_ptr<Pages> pages_;
  TcpServer server_;
};

}  // namespace strainwave::bench
