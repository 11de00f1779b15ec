// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sources/tcp_stream_source.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <system_error>
#include <thread>

#include "daq/acquisition/sources/steady_now.h"

namespace strainwave::daq::acquisition {
namespace {

using std::chrono::nanoseconds;

// Whether the socket is ready within `patience`.
bool WaitFor(int fd, short events, nanoseconds patience) {
  pollfd ready{fd, events, 0};
  // Rounded up, so that a wait of less than 1 ms does not spin.
  const auto wait_ms =
      std::chrono::ceil<std::chrono::milliseconds>(std::max(patience, nanoseconds(0))).count();
  return ::poll(&ready, 1, static_cast<int>(std::min<std::int64_t>(wait_ms, 1 << 30))) > 0;
}

bool SameChannels(const SourceDescription& a, const SourceDescription& b) {
  return a.type == b.type && a.rate_hz == b.rate_hz && a.most_samples_a_block == b.most_samples_a_block &&
         std::equal(a.channels.begin(), a.channels.end(), b.channels.begin(), b.channels.end(),
                    [](const ChannelDescription& x, const ChannelDescription& y) {
                      return x.name == y.name && x.unit == y.unit && x.sensor_serial == y.sensor_serial;
                    });
}

}  // namespace

void TcpStreamSource::Connect(nanoseconds patience) {
  const std::string where = fmt::format("{}:{}", settings_.host, settings_.port);
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found{};
  if (const int error =
          ::getaddrinfo(settings_.host.c_str(), std::to_string(settings_.port).c_str(), &hints, &found);
      error != 0) {
    throw std::system_error(std::make_error_code(std::errc::host_unreachable),
                            fmt::format("{}: {}", where, ::gai_strerror(error)));
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, ::freeaddrinfo);
  int last_error = ECONNREFUSED;
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    FileDescriptor socket(::socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (!socket.is_open()) {
      last_error = errno;
      continue;
    }
    if (::connect(socket.get(), address->ai_addr, address->ai_addrlen) != 0) {
      last_error = errno;
      if (errno != EINPROGRESS) continue;
      if (!WaitFor(socket.get(), POLLOUT, patience)) {
        last_error = ETIMEDOUT;
        continue;
      }
      socklen_t size = sizeof(last_error);
      if (::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &last_error, &size) != 0 || last_error != 0)
        continue;
    }
    socket_ = std::move(socket);
    decoder_.Reset();
    last_message_ = SteadyNow();
    ++connections_;
    return;
  }
  throw std::system_error(last_error, std::generic_category(), fmt::format("cannot connect to {}", where));
}

void TcpStreamSource::Start() {
  has_ended_ = false;
  last_attempt_ = SteadyNow();
  const nanoseconds deadline = SteadyNow() + settings_.hello_within;
  Connect(settings_.hello_within);
  SampleBlock none(0);
  while (decoder_.Next(none) != TcpStreamEvent::kHello) {
    const nanoseconds left = deadline - SteadyNow();
    if (left.count() <= 0 || ReadSome(left) == Read::kClosed) {
      const std::string why =
          decoder_.damage().last.empty() ? "" : fmt::format(" ({})", decoder_.damage().last);
      socket_ = FileDescriptor(-1);
      throw std::system_error(std::make_error_code(std::errc::protocol_error),
                              fmt::format("{}:{} sends no hello{}", settings_.host, settings_.port, why));
    }
  }
  description_ = *decoder_.description();
  description_.source = settings_.source;
}

void TcpStreamSource::Stop() noexcept { socket_ = FileDescriptor(-1); }

TcpStreamSource::Read TcpStreamSource::ReadSome(nanoseconds patience) {
  if (!WaitFor(socket_.get(), POLLIN, patience)) return Read::kNothing;
  const std::span<std::byte> room = decoder_.Room();
  const ssize_t got = ::recv(socket_.get(), room.data(), room.size(), 0);
  if (got > 0) {
    decoder_.Received(static_cast<std::size_t>(got));
    return Read::kSome;
  }
  const bool waits = got < 0 && (errno == EAGAIN || errno == EINTR);
  return waits ? Read::kNothing : Read::kClosed;
}

NextResult TcpStreamSource::Lose(std::string why) {
  socket_ = FileDescriptor(-1);
  trouble_ = fmt::format("{}:{}: {}", settings_.host, settings_.port, why);
  return NextResult::kFailed;
}

bool TcpStreamSource::Reconnect(nanoseconds patience) {
  const nanoseconds wait = last_attempt_ + settings_.between_connections - SteadyNow();
  if (wait > patience) {
    std::this_thread::sleep_for(patience);
    return false;
  }
  if (wait.count() > 0) std::this_thread::sleep_for(wait);
  last_attempt_ = SteadyNow();
  try {
    Connect(patience);
  } catch (const std::system_error& error) {
    trouble_ = error.what();
    return false;
  }
  return true;
}

NextResult TcpStreamSource::Next(SampleBlock& block, nanoseconds patience) {
  if (has_ended_) return NextResult::kEnded;
  const nanoseconds deadline = SteadyNow() + patience;
  if (!socket_.is_open() && !Reconnect(patience)) return NextResult::kNothingYet;
  bool is_last_look = false;
  while (true) {
    const TcpStreamEvent event = decoder_.Next(block);
    if (event != TcpStreamEvent::kNeedsMore) last_message_ = SteadyNow();
    switch (event) {
      case TcpStreamEvent::kBlock:
        block.header.source = settings_.source;
        block.header.arrival = last_message_;
        return NextResult::kBlock;
      case TcpStreamEvent::kHello:
        if (!SameChannels(*decoder_.description(), description_)) return Lose("other channels than before");
        continue;
      case TcpStreamEvent::kKeepAlive:
        continue;
      case TcpStreamEvent::kEnd:
        has_ended_ = true;
        return NextResult::kEnded;
      case TcpStreamEvent::kNeedsMore:
        break;
    }
    if (is_last_look) return NextResult::kNothingYet;
    const nanoseconds now = SteadyNow();
    if (now - last_message_ > settings_.silent_after) {
      return Lose(fmt::format("no message for {} ms", settings_.silent_after.count()));
    }
    // Once more when patience is over: a block may be there already.
    is_last_look = now >= deadline;
    if (ReadSome(deadline - now) == Read::kClosed) return Lose("the connection was closed");
  }
}

}  // namespace strainwave::daq::acquisition
