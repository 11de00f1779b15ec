// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_tcp.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fmt/format.h>

namespace strainwave::bench {

namespace {

constexpr std::uint32_t kMostWaited = 32'768;  // requests back that an answer may be late

}  // namespace

using Outcome = ModbusReply::Outcome;
using protocols::modbus::kMbapLength;
using protocols::modbus::Mbap;
using protocols::modbus::Pdu;

void ModbusTcp::Open() {
  const auto& port = std::get<ModbusTcpPort>(settings_.port);
  ModbusContext context(modbus_new_tcp_pi(port.host.c_str(), fmt::format("{}", port.port).c_str()));
  const ModbusTime time = ModbusTimeOf(settings_.answer_time);
  if (context == nullptr ||
      modbus_set_response_timeout(context.get(), time.seconds, time.microseconds) != 0 ||
      modbus_connect(context.get()) != 0) {
    throw std::system_error(errno, std::generic_category(),
                            fmt::format("no Modbus connection to {} port {}", port.host, port.port));
  }
  context_ = std::move(context);
  socket_ = modbus_get_socket(context_.get());
  received_ = 0;
  asked_ = 0;
  ++counts_.connections;
}

bool ModbusTcp::Send(const Pdu& pdu) noexcept {
  std::array<std::uint8_t, protocols::modbus::kLongestTcpFrame> frame;
  const auto head = protocols::modbus::MbapBytes({++transaction_, 0, static_cast<std::uint16_t>(1 + pdu.size),
                                                  static_cast<std::uint8_t>(settings_.unit)});
  std::ranges::copy(head, frame.begin());
  std::ranges::copy(pdu.span(), frame.begin() + kMbapLength);
  const std::size_t size = kMbapLength + pdu.size;
  // A peer that reads nothing is as good as gone; a request is far shorter than the socket's memory.
  return ::send(socket_, frame.data(), size, MSG_NOSIGNAL | MSG_DONTWAIT) == static_cast<ssize_t>(size);
}

// Takes no more than one frame from the socket, so that what follows stays there.
ModbusTcp::Received ModbusTcp::Receive(Deadline deadline, const Wake* wake) noexcept {
  for (;;) {
    std::size_t wanted = kMbapLength;
    if (received_ >= kMbapLength) {
      const Mbap mbap = *protocols::modbus::TakeMbap(frame_);
      if (mbap.protocol != 0 || mbap.length < 2 || mbap.length + kMbapLength - 1 > frame_.size()) {
        return Received::kNoFrame;
      }
      wanted = mbap.length + kMbapLength - 1;
      if (received_ == wanted) {
        length_ = wanted;
        received_ = 0;
        return Received::kFrame;
      }
    }
    switch (WaitReadable(socket_, wake, deadline - std::chrono::steady_clock::now())) {
      case Waited::kTimeout:
        return Received::kTimeout;
      case Waited::kCalled:
        return Received::kCalled;
      case Waited::kReadable:
        break;
    }
    const ssize_t got = ::recv(socket_, frame_.data() + received_, wanted - received_, MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (got <= 0) return Received::kGone;
    received_ += static_cast<std::size_t>(got);
  }
}

ModbusReply ModbusTcp::Distrust(const char* detail) {
  Close();
  return WrongAnswer(detail, counts_);
}

ModbusReply ModbusTcp::Ask(const Pdu& pdu, std::span<std::uint16_t> words, const Wake* wake) {
  if (!is_open()) return {Outcome::kDisconnected};
  ++counts_.requests;
  asked_ = std::min<std::uint32_t>(asked_ + 1, kMostWaited);
  if (!Send(pdu)) {
    Close();
    return {Outcome::kDisconnected};
  }
  const Deadline deadline = std::chrono::steady_clock::now() + settings_.answer_time;
  for (;;) {
    switch (Receive(deadline, wake)) {
      case Received::kTimeout:
        ++counts_.timeouts;
        if (received_ > 0) return Distrust("half of it came");
        return {Outcome::kTimeout};
      case Received::kCalled:
        return {Outcome::kInterrupted};
      case Received::kGone:
        Close();
        return {Outcome::kDisconnected};
      case Received::kNoFrame:
        return Distrust("its envelope is not one of Modbus TCP");
      case Received::kFrame:
        break;
    }
    const Mbap mbap = *protocols::modbus::TakeMbap(frame_);
    const auto age = static_cast<std::uint16_t>(transaction_ - mbap.transaction);
    if (age >= asked_) return WrongAnswer("its transaction number is that of no request", counts_);
    if (age > 0) {
      ++counts_.late_answers;
      continue;
    }
    if (mbap.unit != settings_.unit) return WrongAnswer("it is from another unit", counts_);
    return ReplyOf(pdu, std::span(frame_).first(length_).subspan(kMbapLength), words, counts_);
  }
}

}  // namespace strainwave::bench
