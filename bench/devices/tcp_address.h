// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace strainwave::bench {

struct TcpAddress {
  std::string host;
  int port{};  // 0: any
};

/// "tcp:HOST:PORT"; an address of IPv6 stands in brackets, "tcp:[::1]:502". @throws std::invalid_argument
/// naming what was expected.
TcpAddress ParseTcpAddress(std::string_view text);

}  // namespace strainwave::bench
