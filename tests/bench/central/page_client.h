// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <string>

#include <fmt/core.h>

namespace strainwave {

/// What the page of all benches has answered.
struct PageAnswer {
  int status{};
  std::string head;
  std::string body;
};

//// Its own few lines: Debian's cpp-httplib has a client whose layout depends on how the library was built.
inline PageAnswer Asked(int port, const std::string& path, const std::string& method = "GET",
                        const std::string& host = "127.0.0.1") {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const std::string request =
      fmt::format("{} {} HTTP/1.1\r\nHost: {}\r\nContent-Length: 0\r\n\r\n", method, path, host);
  EXPECT_EQ(::write(socket, request.data(), request.size()), static_cast<ssize_t>(request.size()));
  std::string answer;
  char part[4096];
  for (ssize_t count{}; (count = ::read(socket, part, sizeof part)) > 0;)
    answer.append(part, static_cast<std::size_t>(count));
  ::close(socket);
  const std::size_t end = answer.find("\r\n\r\n");
  if (end == answer.npos) return {};
  return {std::stoi(answer.substr(9, 3)), answer.substr(0, end), answer.substr(end + 4)};
}

}  // namespace strainwave
