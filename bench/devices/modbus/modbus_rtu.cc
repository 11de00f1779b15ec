// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_rtu.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <vector>

namespace strainwave::bench {
namespace {

using Outcome = ModbusReply::Outcome;
using protocols::modbus::Pdu;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

constexpr std::chrono::microseconds kByteTime{50'000};  // USB adapters hand on bytes in lumps of 16 ms
constexpr std::size_t kUnit = 1, kCrc = 2;
constexpr std::uint8_t kDiagnostics = 8;

nanoseconds SilenceOf(const ModbusSerialLine& line) {
  constexpr nanoseconds kAbove19200{1'750'000};
  if (line.baud > 19'200) return kAbove19200;
  constexpr double kBits = 3.5 * 11;
  return nanoseconds(static_cast<std::int64_t>(kBits / line.baud * 1e9));
}

}  // namespace

ModbusRtu::ModbusRtu(const ModbusSettings& settings, ModbusCounts& counts)
    : settings_(settings),
      port_(std::get<ModbusSerialLine>(settings.port)),
      counts_(counts),
      silence_(SilenceOf(port_)) {}

void ModbusRtu::Open() {
  ModbusContext context(modbus_new_rtu(port_.path.c_str(), port_.baud, port_.parity, 8, port_.stop_bits));
  const ModbusTime time = ModbusTimeOf(settings_.answer_time);
  const ModbusTime byte = ModbusTimeOf(kByteTime);
  if (context == nullptr || modbus_set_slave(context.get(), settings_.unit) != 0 ||
      modbus_set_response_timeout(context.get(), time.seconds, time.microseconds) != 0 ||
      modbus_set_byte_timeout(context.get(), byte.seconds, byte.microseconds) != 0 ||
      modbus_connect(context.get()) != 0) {
    throw std::system_error(errno, std::generic_category(), fmt::format("no Modbus line at {}", port_.path));
  }
  context_ = std::move(context);
  line_ = modbus_get_socket(context_.get());
  // What was asked before this program came may still be answered.
  if (!WaitForSilence(settings_.answer_time, 4 * settings_.answer_time)) {
    Close();
    throw std::system_error(EBUSY, std::generic_category(), fmt::format("{} is never silent", port_.path));
  }
  in_step_ = true;
  ++counts_.connections;
}

bool ModbusRtu::WaitForSilence(nanoseconds silence, nanoseconds longest) {
  const auto end = steady_clock::now() + longest;
  while (WaitReadable(line_, nullptr, silence) == Waited::kReadable) {
    std::uint8_t passed_over[256];
    if (::read(line_, passed_over, sizeof(passed_over)) <= 0 && errno != EAGAIN) {
      Close();
      return false;
    }
    if (steady_clock::now() > end) return false;
  }
  return true;
}

bool ModbusRtu::Send(std::span<const std::uint8_t> pdu) {
  std::vector<std::uint8_t> request{static_cast<std::uint8_t>(settings_.unit)};
  request.insert(request.end(), pdu.begin(), pdu.end());
  ++counts_.requests;
  if (modbus_send_raw_request(context_.get(), request.data(), static_cast<int>(request.size())) < 0) Close();
  return is_open();
}

bool ModbusRtu::AwaitEcho() {
  // The checksums are not looked at: a number of 16 bits stands in the echo, and a refusal is what it is.
  const std::uint8_t unit = static_cast<std::uint8_t>(settings_.unit);
  const std::uint8_t echo[] = {
      unit, kDiagnostics, 0, 0, static_cast<std::uint8_t>(echo_ >> 8), static_cast<std::uint8_t>(echo_)};
  const std::uint8_t refusal[] = {unit, kDiagnostics | 0x80, 1};
  std::vector<std::uint8_t> came;
  const auto ends_in = [&](std::span<const std::uint8_t> frame) {
    return came.size() >= frame.size() + kCrc &&
           std::equal(frame.begin(), frame.end(),
                      came.end() - static_cast<std::ptrdiff_t>(frame.size() + kCrc));
  };
  const auto deadline = steady_clock::now() + settings_.answer_time;
  while (WaitReadable(line_, nullptr, deadline - steady_clock::now()) == Waited::kReadable) {
    std::uint8_t byte = 0;
    if (::read(line_, &byte, 1) != 1) {
      if (errno == EAGAIN) continue;
      Close();
      return false;
    }
    came.push_back(byte);
    if (ends_in(echo) || ends_in(refusal)) {
      if (came.size() > std::size(echo) + kCrc) ++counts_.late_answers;
      return true;
    }
  }
  ++counts_.timeouts;
  return false;
}

bool ModbusRtu::ComeBackInStep() {
  if (in_step_) return true;
  if (!port_.answers_echo) {
    in_step_ = WaitForSilence(2 * settings_.answer_time, 4 * settings_.answer_time);
    return in_step_;
  }
  ++echo_;
  const std::uint8_t pdu[] = {kDiagnostics, 0, 0, static_cast<std::uint8_t>(echo_ >> 8),
                              static_cast<std::uint8_t>(echo_)};
  in_step_ = WaitForSilence(silence_, settings_.answer_time) && Send(pdu) && AwaitEcho();
  return in_step_;
}

ModbusReply ModbusRtu::Receive(const Pdu& pdu, std::span<std::uint16_t> words) {
  std::uint8_t frame[MODBUS_RTU_MAX_ADU_LENGTH];
  const int got = modbus_receive_confirmation(context_.get(), frame);
  // libmodbus lets unit 0 pass as every unit's; it is that of a broadcast, and no device answers as it.
  if (got == 0 || (got > 0 && frame[0] != settings_.unit)) {
    return WrongAnswer("it is from another unit", counts_);
  }
  if (got < 0) {
    const int error = errno;
    if (error == ETIMEDOUT) {
      ++counts_.timeouts;
      return {Outcome::kTimeout};
    }
    if (error == EMBBADCRC) return WrongAnswer("its checksum is wrong", counts_);
    if (error == EMBBADDATA) return WrongAnswer("it is longer than a frame", counts_);
    Close();
    return {Outcome::kDisconnected};
  }
  const auto length = static_cast<std::size_t>(got);
  if (length < kUnit + 1 + kCrc) return WrongAnswer("it is shorter than a frame", counts_);
  return ReplyOf(pdu, std::span(frame).first(length - kCrc).subspan(kUnit), words, counts_);
}

ModbusReply ModbusRtu::Ask(const Pdu& pdu, std::span<std::uint16_t> words, const Wake*) {
  if (!is_open()) return {Outcome::kDisconnected};
  if (!ComeBackInStep()) return {is_open() ? Outcome::kTimeout : Outcome::kDisconnected};
  if (!WaitForSilence(silence_, settings_.answer_time)) {
    if (is_open()) return WrongAnswer("the line is never silent", counts_);
    return {Outcome::kDisconnected};
  }
  if (!Send(pdu.span())) return {Outcome::kDisconnected};
  const ModbusReply reply = Receive(pdu, words);
  in_step_ = reply.good() || reply.outcome == Outcome::kException;
  return reply;
}

}  // namespace strainwave::bench
