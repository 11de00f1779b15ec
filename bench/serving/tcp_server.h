// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "bench/devices/wake.h"
#include "bench/serving/byte_link.h"

namespace strainwave::bench {

/// Where a server listens, and whom it bears.
struct ListenSettings {
  std::string address;
  int port{};                               // 0: any free one
  std::size_t connections{32};              // at a time; one more takes the place of another
  std::size_t of_one_network{connections};  // likewise of one machine (NetworkOf)
  std::int64_t idle_after_ms{60'000};
  const TlsIdentity* tls{};  // outlives the server; nothing: not encrypted
};

/// What a TcpServer says to a request. Called from its thread alone.
class RequestProtocol {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using ClientId = std::uint64_t;  // of a connection; never given twice

  /// Who sends a request: a connection, and the addresses at its two ends (addresses.h).
  struct Caller {
    ClientId id{};
    std::string address;      // theirs
    std::string own_address;  // of this machine, to which the connection was made
  };

  struct Reply {
    std::string bytes;
    bool closes{};  // the connection, once the client has them
    bool waits{};   // the client asks for nothing more and gets the rest by `Deliveries`
  };
  /// What a waiting client gets; nobody, where it has left.
  struct Delivery {
    ClientId client{};
    std::string bytes;
    bool closes{};
  };
  enum class Refusal { kTooLong, kTooSlow };

  RequestProtocol() = default;
  RequestProtocol(const RequestProtocol&) = delete;
  RequestProtocol& operator=(const RequestProtocol&) = delete;
  virtual ~RequestProtocol() = default;

  /// Of the first request in `received`, in bytes; nothing while it is not whole.
  virtual std::optional<std::size_t> LengthOf(std::string_view received) = 0;
  virtual Reply Answer(std::string_view request, const Caller& caller) = 0;
  /// Asked in every round of the server's loop, which a call of `Wake` begins at once.
  virtual std::vector<Delivery> Deliveries(Time) { return {}; }
  /// A client that was told to wait has left, or was closed.
  virtual void Left(ClientId) {}
  /// The last words to a client whose request is too long, or not whole in time.
  virtual std::string LastWords(Refusal) { return {}; }
};

/// What a server bears of a client.
struct ServerLimits {
  std::size_t longest_request_bytes{4096};
  std::chrono::seconds request_within{1};  // of its first byte
  std::chrono::seconds answer_within{1};   // a client that has not taken its bytes by then is closed
  std::size_t most_unsent_bytes{1 << 20};  // that one client has not taken when it is to be given more
  /// After the last bytes the client closes first, within `request_within`: what it still sends is not read,
  /// and does not take the answer from it.
  bool lingers{};
};

/// Answers many clients from one thread, which waits for all of them at once and for none: a new client
/// always gets in. Where there are as many as the settings allow, or the process has few files left, it takes
/// the place of the longest idle: of the strangers, who have had no answer yet or all that they get, while
/// these are half of all or more; else of those who are served. So whoever only connects takes at most half
/// of the places. Closed are those that have said nothing for `idle_after`, unless they were told to wait,
/// and those that go beyond the limits. A client that waits costs a socket, and no thread.
class TcpServer {
 public:
  /// @param name  of the protocol, for messages.
  /// @param protocol  outlives the server.
  /// @throws std::system_error when it cannot listen there.
  TcpServer(std::string_view name, const ListenSettings& settings, RequestProtocol& protocol,
            const ServerLimits& limits = {});
  TcpServer(const TcpServer&) = delete;
  TcpServer& operator=(const TcpServer&) = delete;
  ~TcpServer();

  int port() const { return port_; }
  /// There is something to deliver. From any thread; returns at once.
  void Wake() noexcept { wake_.Call(); }

 private:
  using Time = RequestProtocol::Time;

  struct Client {
    int socket{};
    std::unique_ptr<ByteLink> link{};
    RequestProtocol::Caller caller{};
    std::string network{};      // of the caller
    Time served{};              // the last time that it was given an answer, or let in
    bool answered{};            // at least once
    std::optional<Time> due{};  // by which the rest of a request must have come, and an answer have gone
    std::string received{};
    std::string unsent{};
    bool closes{};
    bool waits{};
    bool leaves{};  // has had its last bytes, and is to close
  };

  void Serve();
  void LetIn(Time now);
  /// Closes one. @param network  of whom; empty: of all.
  void MakeRoom(std::string_view network);
  /// @return the one after it.
  std::list<Client>::iterator Close(std::list<Client>::iterator client);
  void Deliver(Time now);
  /// False where the client is to be closed.
  bool IsWelcome(Client& client, Time now);
  bool Receive(Client& client);
  bool Proceed(Client& client, Time now);
  bool Refuse(Client& client, RequestProtocol::Refusal why, Time now);
  bool SendUnsent(Client& client);
  bool Linger(Client& client, Time now);

  RequestProtocol& protocol_;
  const ServerLimits limits_;
  const std::size_t most_clients_;
  const std::size_t most_of_one_;
  const std::chrono::milliseconds idle_after_;
  const TlsIdentity* const tls_;
  const int first_beyond_;
  int listener_{-1};
  int port_{};
  RequestProtocol::ClientId last_id_{};
  std::list<Client> clients_;
  bench::Wake wake_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace strainwave::bench
