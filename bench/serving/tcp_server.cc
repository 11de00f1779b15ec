// SPDX-License-Identifier: Apache-2.0
#include "bench/serving/tcp_server.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/serving/addresses.h"

namespace strainwave::bench {
namespace {

constexpr int kPatience_ms = 100;  // in which a stop is seen, and a client that is due
constexpr std::size_t kBuffer_bytes = 4096;
constexpr rlim_t kMostKeptFree = 64;  // files, for the rest of the process

int ListenAt(const addrinfo& place) {
  const int listener =
      ::socket(place.ai_family, place.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, place.ai_protocol);
  if (listener < 0) return -1;
  const int yes = 1;
  ::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  if (::bind(listener, place.ai_addr, place.ai_addrlen) == 0 && ::listen(listener, SOMAXCONN) == 0) {
    return listener;
  }
  const int error = errno;
  ::close(listener);
  errno = error;
  return -1;
}

// −1 with errno where it cannot be.
int Listen(const ListenSettings& settings) {
  addrinfo wanted{};
  wanted.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(settings.address.c_str(), std::to_string(settings.port).c_str(), &wanted, &found) != 0) {
    errno = EADDRNOTAVAIL;
    return -1;
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> places(found, &::freeaddrinfo);
  int listener = -1;
  for (const addrinfo* place = found; place != nullptr && listener < 0; place = place->ai_next) {
    listener = ListenAt(*place);
  }
  return listener;
}

sockaddr_storage OwnEnd(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  return address;
}

int PortOf(int listener) {
  const sockaddr_storage address = OwnEnd(listener);
  return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                                             : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

// The lowest descriptor that would leave the process too few.
int FirstBeyond() {
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return std::numeric_limits<int>::max();
  const rlim_t kept_free = std::min(kMostKeptFree, files.rlim_cur / 4);
  return static_cast<int>(std::min<rlim_t>(files.rlim_cur - kept_free, std::numeric_limits<int>::max()));
}

// The same socket under the lowest descriptor that is free now.
int AtTheLowest(int socket) {
  const int lowest = ::fcntl(socket, F_DUPFD_CLOEXEC, 0);
  if (lowest < 0) return socket;
  ::close(socket);
  return lowest;
}

bool WouldWait() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

TcpServer::TcpServer(std::string_view name, const ListenSettings& settings, RequestProtocol& protocol,
                     const ServerLimits& limits)
    : protocol_(protocol),
      limits_(limits),
      most_clients_(settings.connections),
      most_of_one_(settings.of_one_network),
      idle_after_(settings.idle_after_ms),
      tls_(settings.tls),
      first_beyond_(FirstBeyond()),
      listener_(Listen(settings)) {
  if (listener_ < 0) {
    throw std::system_error(
        errno, std::generic_category(),
        fmt::format("{} cannot listen on {} port {}", name, settings.address, settings.port));
  }
  port_ = PortOf(listener_);
  thread_ = std::thread([this] { Serve(); });
}

TcpServer::~TcpServer() {
  stop_ = true;
  wake_.Call();
  thread_.join();
  for (const Client& client : clients_) ::close(client.socket);
  ::close(listener_);
}

void TcpServer::Serve() {
  std::vector<pollfd> sockets;
  while (!stop_) {
    sockets.assign({{listener_, POLLIN, 0}, {wake_.descriptor(), POLLIN, 0}});
    for (const Client& client : clients_) {
      const short own = client.link->Waits();
      const auto usual = static_cast<short>(client.unsent.empty() ? POLLIN : POLLOUT);
      sockets.push_back({client.socket, own != 0 ? own : usual, 0});
    }
    const bool more =
        std::ranges::any_of(clients_, [](const Client& client) { return client.link->HasMore(); });
    if (::poll(sockets.data(), sockets.size(), more ? 0 : kPatience_ms) < 0) continue;
    wake_.Take();
    const Time now = std::chrono::steady_clock::now();
    auto polled = sockets.begin() + 1;
    for (auto client = clients_.begin(); client != clients_.end();) {
      const bool ready = (++polled)->revents != 0 || client->link->HasMore();
      const bool stays = (!ready || (Receive(*client) && Proceed(*client, now))) && IsWelcome(*client, now);
      client = stays ? std::next(client) : Close(client);
    }
    Deliver(now);
    if (sockets[0].revents != 0) LetIn(now);
  }
}

std::list<TcpServer::Client>::iterator TcpServer::Close(std::list<Client>::iterator client) {
  ::close(client->socket);
  if (client->waits) protocol_.Left(client->caller.id);
  return clients_.erase(client);
}

bool TcpServer::IsWelcome(Client& client, Time now) {
  if (client.due && now >= *client.due) {
    const bool half_a_request = !client.received.empty() && client.unsent.empty() && !client.waits;
    return half_a_request && Refuse(client, RequestProtocol::Refusal::kTooSlow, now);
  }
  return client.waits || now - client.served < idle_after_;
}

void TcpServer::Deliver(Time now) {
  for (RequestProtocol::Delivery& delivery : protocol_.Deliveries(now)) {
    const auto client =
        std::ranges::find(clients_, delivery.client, [](const Client& one) { return one.caller.id; });
    if (client == clients_.end()) continue;
    const bool keeps_up = client->unsent.size() <= limits_.most_unsent_bytes;
    client->unsent += delivery.bytes;
    client->closes = client->closes || delivery.closes;
    client->waits = !delivery.closes;
    client->served = now;
    const bool stays = keeps_up && Proceed(*client, now);
    if (stays) continue;
    client->waits = true;  // so that it is told of
    Close(client);
  }
}

void TcpServer::LetIn(Time now) {
  // No more than there is room for, or a flood of them would keep those waiting that are in.
  for (std::size_t i = 0; i < most_clients_; ++i) {
    sockaddr_storage from{};
    socklen_t size = sizeof(from);
    int socket =
        ::accept4(listener_, reinterpret_cast<sockaddr*>(&from), &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (socket < 0 && (errno == EMFILE || errno == ENFILE)) {
      // The next round finds a descriptor.
      clients_.empty() ? static_cast<void>(::poll(nullptr, 0, kPatience_ms)) : MakeRoom({});
    }
    if (socket < 0) return;
    const std::string address = AddressText(from);
    const std::string network = NetworkOf(address);
    const auto of_one = std::ranges::count(clients_, network, &Client::network);
    if (static_cast<std::size_t>(of_one) >= most_of_one_) MakeRoom(network);
    if (clients_.size() >= most_clients_ || socket >= first_beyond_) MakeRoom({});
    if (socket >= first_beyond_) socket = AtTheLowest(socket);
    clients_.push_back({.socket = socket,
                        .link = tls_ == nullptr ? PlainLink(socket) : tls_->Link(socket),
                        .caller = {++last_id_, address, AddressText(OwnEnd(socket))},
                        .network = network,
                        .served = now});
    // What it has sent already is looked at before another one may take its place.
    const auto client = std::prev(clients_.end());
    if (!Receive(*client) || !Proceed(*client, now)) Close(client);
  }
}

void TcpServer::MakeRoom(std::string_view network) {
  auto stranger = clients_.end();
  auto idle = clients_.end();
  std::size_t all = 0;
  std::size_t strangers = 0;
  for (auto client = clients_.begin(); client != clients_.end(); ++client) {
    if (!network.empty() && client->network != network) continue;
    const bool is_served = client->answered && !client->closes;
    auto& longest = is_served ? idle : stranger;
    if (longest == clients_.end() || client->served < longest->served) longest = client;
    ++all;
    strangers += is_served ? 0 : 1;
  }
  const bool are_many = strangers >= std::max<std::size_t>(all / 2, 1);
  const auto leaves = are_many ? stranger : idle;
  if (leaves != clients_.end()) Close(leaves);
}

bool TcpServer::Receive(Client& client) {
  if (!client.unsent.empty()) return true;
  std::array<char, kBuffer_bytes> buffer{};
  if (client.leaves) {
    const ssize_t count = client.link->Read(buffer.data(), buffer.size());
    return count > 0 || (count < 0 && WouldWait());
  }
  // What is not a whole request yet is shorter than the longest one, or the client would have been closed;
  // one that waits has nothing more to say.
  const std::size_t room = limits_.longest_request_bytes - client.received.size();
  if (room == 0) return false;
  const ssize_t count = client.link->Read(buffer.data(), std::min(buffer.size(), room));
  if (count < 0) return WouldWait();
  client.received.append(buffer.data(), static_cast<std::size_t>(count));
  if (client.waits && count == 0) return false;  // nobody is there to wait
  client.closes = client.closes || count == 0;   // what it has asked for before is answered
  return true;
}

bool TcpServer::SendUnsent(Client& client) {
  const ssize_t count = client.link->Write(client.unsent);
  if (count < 0 && !WouldWait()) return false;
  client.unsent.erase(0, static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  if (client.unsent.empty()) client.due.reset();
  return true;
}

bool TcpServer::Linger(Client& client, Time now) {
  if (!limits_.lingers) return false;
  client.link->EndWriting();
  client.leaves = true;
  client.due = now + limits_.request_within;
  client.received.clear();
  return true;
}

bool TcpServer::Refuse(Client& client, RequestProtocol::Refusal why, Time now) {
  client.unsent = protocol_.LastWords(why);
  if (client.unsent.empty()) return false;
  client.closes = true;
  client.received.clear();
  client.due.reset();
  return Proceed(client, now);
}

bool TcpServer::Proceed(Client& client, Time now) {
  if (client.leaves) return true;
  while (true) {
    if (!client.unsent.empty()) {
      if (!SendUnsent(client)) return false;
      if (!client.unsent.empty()) break;
    }
    if (client.waits) return true;
    const std::optional<std::size_t> length = protocol_.LengthOf(client.received);
    if (!length && client.closes) return client.received.empty() && Linger(client, now);
    if (!length && client.received.size() >= limits_.longest_request_bytes) {
      return Refuse(client, RequestProtocol::Refusal::kTooLong, now);
    }
    if (!length) break;
    RequestProtocol::Reply reply =
        protocol_.Answer(std::string_view(client.received).substr(0, *length), client.caller);
    client.received.erase(0, *length);
    client.unsent = std::move(reply.bytes);
    client.served = now;
    client.answered = true;
    client.due.reset();
    client.waits = reply.waits;
    if (reply.closes) {
      client.closes = true;
      client.received.clear();
    }
    if (client.unsent.empty() && client.closes && !client.waits) return false;
  }
  const bool waits = !client.received.empty() || !client.unsent.empty();
  const auto within = client.unsent.empty() ? limits_.request_within : limits_.answer_within;
  if (waits && !client.due) client.due = now + within;
  return true;
}

}  // namespace strainwave::bench
