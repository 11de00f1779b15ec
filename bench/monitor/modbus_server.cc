// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/modbus_server.h"

#include <cstdint>
#include <span>

#include "bench/monitor/modbus_registers.h"
#include "protocols/modbus/pdu.h"

namespace strainwave::bench {

using namespace protocols::modbus;

namespace {

std::span<const std::uint8_t> Bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// Unit and function at least; the unit is counted twice, in the length and in the envelope.
bool IsModbus(const Mbap& mbap) {
  return mbap.protocol == 0 && mbap.length >= 2 && kMbapLength - 1 + mbap.length <= kLongestTcpFrame;
}

}  // namespace

std::optional<std::size_t> ModbusProtocol::LengthOf(std::string_view received) {
  const std::optional<Mbap> mbap = TakeMbap(Bytes(received));
  if (!mbap) return std::nullopt;
  if (!IsModbus(*mbap)) return received.size();
  const std::size_t length = kMbapLength - 1 + mbap->length;
  return length <= received.size() ? std::optional(length) : std::nullopt;
}

RequestProtocol::Reply ModbusProtocol::Answer(std::string_view request, const Caller&) {
  Mbap mbap = *TakeMbap(Bytes(request));
  // Where a request ends that is not Modbus, and another begins, cannot be known.
  if (!IsModbus(mbap)) return {.bytes = {}, .closes = true};
  const Pdu answer =
      AnswerFromInputRegisters(Bytes(request).subspan(kMbapLength),
                               ModbusRegisters(board_.State(), board_.frame(), board_.NowMilliseconds()));
  mbap.length = static_cast<std::uint16_t>(1 + answer.size);
  const auto envelope = MbapBytes(mbap);
  Reply reply{.bytes = std::string(envelope.begin(), envelope.end())};
  reply.bytes.append(answer.span().begin(), answer.span().end());
  return reply;
}

}  // namespace strainwave::bench
