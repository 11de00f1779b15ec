// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "bench/central/schema.h"
#include "bench/central/server.h"

namespace strainwave::bench {

/// A connection that is made when it is asked for. Ten thousand benches that each held one all the time would
/// cost the server a process each.
class ServerSource {
 public:
  ServerSource(std::string conninfo, std::function<bool()> is_to_end, const ServerPatience& patience = {})
      : conninfo_(std::move(conninfo)), is_to_end_(std::move(is_to_end)), patience_(patience) {}

  /// @throws as Server and DemandSchema.
  Server& Get() {
    if (!server_) {
      auto server = std::make_unique<Server>(conninfo_, is_to_end_, patience_);
      DemandSchema(*server);
      server_ = std::move(server);
      ++number_;
    }
    return *server_;
  }
  /// Tells one connection from the next; 0: there was none.
  int number() const { return number_; }
  void Close() { server_.reset(); }

 private:
  std::string conninfo_;
  std::function<bool()> is_to_end_;
  ServerPatience patience_;
  std::unique_ptr<Server> server_;
  int number_{};
};

}  // namespace strainwave::bench
