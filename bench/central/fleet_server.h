// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "bench/serving/tcp_server.h"

namespace strainwave::bench {

struct FleetSettings {
  std::string conninfo;
  int port{};  // of 127.0.0.1; 0: any free one
};

/// The page of all benches, for this machine alone: reads the PostgreSQL server, and changes nothing there.
/// One thread carries all connections; another one asks the server, so that a slow one keeps no page's own
/// files waiting. What several ask within a second is asked once.
class FleetServer {
 public:
  /// @throws std::system_error where it cannot listen there.
  explicit FleetServer(const FleetSettings& settings);
  ~FleetServer();

  int port() const;

 private:
  class FleetPages;
  std::unique_ptr<FleetPages> pages_;
  std::unique_ptr<TcpServer> server_;
};

}  // namespace strainwave::bench
