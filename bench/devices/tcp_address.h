// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace strainwave::bench {

struct TcpAddress {
  std::string host;
  int port{};  // 0: any
};

/// "tcp:HOST:PORT". @throws std::invalid_argument naming what was expected.
TcpAddress ParseTcpAddress(std::string_view text);

}  // namespace strainwave::bench
