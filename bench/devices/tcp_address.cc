// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/tcp_address.h"

#include <charconv>
#include <stdexcept>

#include <fmt/format.h>

namespace strainwave::bench {

TcpAddress ParseTcpAddress(std::string_view text) {
  constexpr std::string_view kScheme = "tcp:";
  constexpr int kMostPort = 65535;
  const auto refuse = [&]() -> TcpAddress {
    throw std::invalid_argument(fmt::format("address = {} (expected tcp:HOST:PORT)", text));
  };
  if (!text.starts_with(kScheme)) return refuse();
  const std::string_view rest = text.substr(kScheme.size());
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return refuse();
  std::string_view host = rest.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  TcpAddress address{std::string(host), 0};
  const std::string_view port = rest.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (error != std::errc() || end != port.data() + port.size() || address.port < 0 ||
      address.port > kMostPort) {
    return refuse();
  }
  return address;
}

}  // namespace strainwave::bench
