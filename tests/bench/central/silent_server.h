// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <stdexcept>
#include <string>

#include <fmt/core.h>

namespace strainwave {

/// Takes connections, as the kernel does for whoever listens, and never says a word.
class SilentServer {
 public:
  SilentServer() : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    if (::bind(listener_, any, size) != 0 || ::listen(listener_, 100) != 0 ||
        ::getsockname(listener_, any, &size) != 0) {
      throw std::runtime_error("cannot listen");
    }
    port_ = ntohs(address.sin_port);
  }
  SilentServer(const SilentServer&) = delete;
  SilentServer& operator=(const SilentServer&) = delete;
  ~SilentServer() { ::close(listener_); }

  std::string Conninfo() const {
    return fmt::format("host=127.0.0.1 port={} dbname=lab user=admin sslmode=disable gssencmode=disable",
                       port_);
  }
  /// That have been made so far; lets go of them.
  int connections() {
    for (int socket{}; (socket = ::accept(listener_, nullptr, nullptr)) >= 0; ++connections_) ::close(socket);
    return connections_;
  }

 private:
  int listener_{-1};
  std::uint16_t port_{};
  int connections_{};
};

}  // namespace strainwave
