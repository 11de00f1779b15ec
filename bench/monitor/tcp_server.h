// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "bench/monitor/settings.h"

namespace strainwave::bench {

/// What a TcpServer says to a request. Called from its thread alone.
class RequestProtocol {
 public:
  struct Reply {
    std::string bytes;
    bool closes{};  // the connection, once the client has them
  };

  RequestProtocol() = default;
  RequestProtocol(const RequestProtocol&) = delete;
  RequestProtocol& operator=(const RequestProtocol&) = delete;
  virtual ~RequestProtocol() = default;

  /// Of the first request in `received`, in bytes; nothing while it is not whole.
  virtual std::optional<std::size_t> LengthOf(std::string_view received) = 0;
  virtual Reply Answer(std::string_view request) = 0;
};

/// Answers many clients from one thread, which waits for all of them at once and for none: a new client
/// always gets in, in place of the one that has said nothing for the longest where there are as many as the
/// settings allow. Closed are those that have said nothing for `idle_after`, whose request is not whole
/// within `kRequestWithin` of its first byte or longer than `kLongestRequest_bytes`, and that do not take
/// their answer within `kRequestWithin`.
class TcpServer {
 public:
  static constexpr std::chrono::seconds kRequestWithin{1};
  static constexpr std::size_t kLongestRequest_bytes = 4096;

  /// @param name  of the protocol, for messages.
  /// @param protocol  outlives the server.
  /// @throws std::system_error when it cannot listen there.
  TcpServer(std::string_view name, const ListenSettings& settings, RequestProtocol& protocol);
  TcpServer(const TcpServer&) = delete;
  TcpServer& operator=(const TcpServer&) = delete;
  ~TcpServer();

  int port() const { return port_; }

 private:
  using Time = std::chrono::steady_clock::time_point;

  struct Client {
    int socket{};
    Time served{};              // the last time that it was given an answer, or let in
    std::optional<Time> due{};  // by which the rest of a request must have come, and an answer have gone
    std::string received{};
    std::string unsent{};
    bool closes{};
  };

  void Serve();
  void LetIn(Time now);
  void CloseLongestIdle();
  /// False where the client is to be closed.
  bool Receive(Client& client);
  bool Proceed(Client& client, Time now);

  RequestProtocol& protocol_;
  const std::size_t most_clients_;
  const std::chrono::milliseconds idle_after_;
  int listener_{-1};
  int port_{};
  std::list<Client> clients_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace strainwave::bench
