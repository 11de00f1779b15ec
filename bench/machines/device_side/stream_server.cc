// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/device_side/stream_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/realtime/realtime.h"
#include "daq/acquisition/tcp_stream_encoder.h"

namespace strainwave::bench {

using daq::acquisition::SampleBlock;
using std::chrono::milliseconds;

namespace {

constexpr double kRoom_s = 2.0;
constexpr milliseconds kKeepAlive{500};
constexpr milliseconds kLook{100};

std::size_t Slots(const daq::acquisition::SourceDescription& description) {
  return static_cast<std::size_t>(kRoom_s * description.rate_hz / description.most_samples_a_block) + 4;
}

[[noreturn]] void ThrowLastError(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

StreamServer::StreamServer(daq::acquisition::SourceDescription description, const std::string& address,
                           int port)
    : description_(std::move(description)),
      ring_(Slots(description_),
            SampleBlock(description_.channels.size() * description_.most_samples_a_block)),
      listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const std::string place = fmt::format("stream {} on {}:{}", description_.name, address, port);
  if (!listener_.is_open()) ThrowLastError(place);
  const int on = 1;
  ::setsockopt(listener_.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::inet_pton(AF_INET, address == "localhost" ? "127.0.0.1" : address.c_str(), &at.sin_addr) != 1) {
    errno = EADDRNOTAVAIL;
    ThrowLastError(place);
  }
  if (::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0) ThrowLastError(place);
  if (::listen(listener_.get(), 1) != 0) ThrowLastError(place);
  socklen_t length = sizeof at;
  ::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&at), &length);
  port_ = ntohs(at.sin_port);
  thread_ = std::thread([this] { Run(); });
}

StreamServer::~StreamServer() {
  ending_ = true;
  wake_.Call();
  thread_.join();
}

void StreamServer::Push(const SampleBlock& block) noexcept {
  if (!connected_) return;
  std::uint64_t to_drop = to_drop_;
  if (to_drop >= block.header.samples) {
    to_drop_ -= block.header.samples;
    dropped_ += block.header.samples;
    return;
  }
  SampleBlock* const slot = ring_.BeginWrite();
  if (slot == nullptr) {
    dropped_ += block.header.samples;
    return;
  }
  slot->CopyFrom(block);
  ring_.EndWrite();
  wake_.Call();
}

void StreamServer::Run() {
  (void)BecomeRealtime(RealtimeRank::kDeviceSide);
  while (!ending_) {
    if (WaitReadable(listener_.get(), &wake_, kLook) != Waited::kReadable) {
      wake_.Take();
      continue;
    }
    daq::FileDescriptor connection(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (!connection.is_open()) continue;
    const int on = 1;
    ::setsockopt(connection.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    while (ring_.BeginRead() != nullptr) ring_.EndRead();  // of an earlier connection
    connected_ = true;
    Serve(connection.get());
    connected_ = false;
  }
}

void StreamServer::Serve(int connection) {
  if (!SendAll(connection, daq::acquisition::EncodeHello(description_))) return;
  std::vector<std::byte> message;
  std::vector<std::byte> messages;
  auto last = std::chrono::steady_clock::now();
  std::uint64_t next_counter = 0;
  std::chrono::nanoseconds next_time{};
  while (!ending_) {
    wake_.Wait(kLook);
    wake_.Take();
    // All that waits goes out at once.
    messages.clear();
    while (SampleBlock* const block = ring_.BeginRead()) {
      daq::acquisition::EncodeBlock(*block, message);
      messages.insert(messages.end(), message.begin(), message.end());
      next_counter = block->header.device_counter + block->header.samples;
      next_time = block->header.device_time;
      ring_.EndRead();
    }
    if (!messages.empty() && !silent_) {
      if (!SendAll(connection, messages)) return;
      last = std::chrono::steady_clock::now();
    }
    if (silent_ || std::chrono::steady_clock::now() - last < kKeepAlive) continue;
    if (!SendAll(connection, daq::acquisition::EncodeKeepAlive(next_counter, next_time))) return;
    last = std::chrono::steady_clock::now();
  }
}

bool StreamServer::SendAll(int connection, std::span<const std::byte> bytes) {
  while (!bytes.empty() && !ending_) {
    pollfd ready{connection, POLLOUT, 0};
    if (::poll(&ready, 1, static_cast<int>(kLook.count())) < 0 && errno != EINTR) return false;
    if ((ready.revents & (POLLERR | POLLHUP)) != 0) return false;
    if ((ready.revents & POLLOUT) == 0) continue;
    const ssize_t sent = ::send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno != EAGAIN && errno != EINTR) return false;
    if (sent > 0) bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return bytes.empty();
}

}  // namespace strainwave::bench
