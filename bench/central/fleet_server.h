// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "bench/central/server.h"
#include "bench/serving/tcp_server.h"

namespace strainwave::bench {

struct FleetSettings {
  std::string conninfo;
  int port{};                                      // of 127.0.0.1; 0: any free one
  std::chrono::milliseconds answer_within{8'000};  // of a question; a server that is later counts as away
  std::chrono::milliseconds first_wait{1'000};     // before a server that is away is asked again
  ServerPatience patience{.to_connect = std::chrono::seconds(30), .to_answer = std::chrono::seconds(10)};
};

/// The page of all benches, for this machine alone: reads the PostgreSQL server, and changes nothing there.
/// One thread carries all connections; another one asks the server, so that a slow one keeps no page's own
/// files waiting. What several ask within a second is asked once. Whoever asks has an answer in time,
/// whatever the server does: 503 with a sentence, at once while it is known to be away.
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
