// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/ioctl.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "bench/devices/modbus/libmodbus.h"
#include "bench/devices/wake.h"

/// A line to a Modbus device, for one fuzz target: after each request the next part of the input comes in,
/// and no time passes: what has not come by then does not come. It stands in for what libmodbus and the
/// transports wait with, by its own `modbus_connect`, `select` and `WaitReadable`.
class FedLine {
 public:
  /// @param input  parts: a byte with the number of bytes in its lower six bits, and these bytes; bit 6: the
  ///   next part comes with it, bit 7: see `Complete`.
  explicit FedLine(std::span<const std::uint8_t> input) : input_(input) { current_ = this; }
  FedLine(const FedLine&) = delete;
  FedLine& operator=(const FedLine&) = delete;
  virtual ~FedLine() {
    if (far_ >= 0) ::close(far_);
    current_ = nullptr;
  }

  static FedLine& Current() { return *current_; }
  bool empty() const { return input_.empty(); }
  std::uint8_t Byte() {
    if (input_.empty()) return 0;
    const std::uint8_t byte = input_[0];
    input_ = input_.subspan(1);
    return byte;
  }
  /// What has come in since the connection was made, and of it what came after the latest request.
  const std::vector<std::uint8_t>& came() const { return came_; }
  std::span<const std::uint8_t> came_last() const { return std::span(came_).subspan(last_); }

  /// @return the near end, which the caller closes.
  int Connect() {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) != 0) std::abort();
    if (far_ >= 0) ::close(far_);
    far_ = ends[1];
    came_.clear();
    last_ = 0;
    return ends[0];
  }

  bool IsReadable(int near) {
    std::uint8_t request[512];
    if (::recv(far_, request, sizeof(request), MSG_DONTWAIT) > 0) Feed();
    int waiting = 0;
    return ::ioctl(near, FIONREAD, &waiting) == 0 && waiting > 0;
  }

 protected:
  /// What the flag asks for is put behind the part.
  virtual void Complete(std::vector<std::uint8_t>&, bool) {}

 private:
  void Feed() {
    last_ = came_.size();
    std::uint8_t head = 0;
    do {
      head = Byte();
      std::vector<std::uint8_t> part;
      for (int i = 0; i < head % 64 && !empty(); ++i) part.push_back(Byte());
      Complete(part, head >> 7 != 0);
      came_.insert(came_.end(), part.begin(), part.end());
    } while ((head & 0x40) != 0);
    const std::span<const std::uint8_t> part = came_last();
    if (::send(far_, part.data(), part.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(part.size())) {
      came_.resize(last_);  // the near end is closed by now
    }
  }

  static inline FedLine* current_ = nullptr;
  std::span<const std::uint8_t> input_;
  int far_{-1};
  std::vector<std::uint8_t> came_;
  std::size_t last_{};
};

extern "C" int modbus_connect(modbus_t* context) {
  return modbus_set_socket(context, FedLine::Current().Connect());
}

extern "C" int select(int ends, fd_set* readable, fd_set*, fd_set*, timeval*) {
  if (FedLine::Current().IsReadable(ends - 1)) return 1;
  FD_ZERO(readable);
  return 0;
}

strainwave::bench::Waited strainwave::bench::WaitReadable(int descriptor, const Wake*,
                                                          std::chrono::nanoseconds) noexcept {
  return FedLine::Current().IsReadable(descriptor) ? Waited::kReadable : Waited::kTimeout;
}
