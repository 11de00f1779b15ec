// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_transport.h"

#include <fmt/format.h>

#include "bench/devices/modbus/modbus_rtu.h"
#include "bench/devices/modbus/modbus_tcp.h"

namespace strainwave::bench {

using Outcome = ModbusReply::Outcome;

std::string Words(const ModbusReply& reply, const ModbusSettings& settings) {
  switch (reply.outcome) {
    case Outcome::kGood:
      return "good";
    case Outcome::kException:
      return fmt::format("refused with exception {}", protocols::modbus::ExceptionText(reply.exception));
    case Outcome::kTimeout:
      return fmt::format("no answer within {} ms, asked {} times", settings.answer_time.count(),
                         settings.retries + 1);
    case Outcome::kWrongAnswer:
      return fmt::format("wrong answer: {}", reply.detail);
    case Outcome::kInterrupted:
      return "interrupted";
    case Outcome::kDisconnected:
      return "the connection is gone";
  }
  return "";
}

ModbusReply WrongAnswer(const char* detail, ModbusCounts& counts) {
  ++counts.wrong_answers;
  return {Outcome::kWrongAnswer, 0, detail};
}

ModbusReply ReplyOf(const protocols::modbus::Pdu& request, std::span<const std::uint8_t> answer,
                    std::span<std::uint16_t> words, ModbusCounts& counts) {
  using protocols::modbus::AnswerKind;
  const protocols::modbus::Answer taken = TakeAnswer(request, answer, words);
  switch (taken.kind) {
    case AnswerKind::kGood:
      return {};
    case AnswerKind::kException:
      ++counts.exceptions;
      return {Outcome::kException, taken.exception};
    case AnswerKind::kOtherFunction:
      return WrongAnswer("it is to another function", counts);
    case AnswerKind::kWrongLength:
      return WrongAnswer("its length is not that which was asked for", counts);
    case AnswerKind::kOtherAddress:
      return WrongAnswer("it confirms another address or value than was written", counts);
  }
  return {};
}

std::unique_ptr<ModbusTransport> MakeTransport(const ModbusSettings& settings, ModbusCounts& counts) {
  if (std::holds_alternative<ModbusTcpPort>(settings.port)) {
    return std::make_unique<ModbusTcp>(settings, counts);
  }
  return std::make_unique<ModbusRtu>(settings, counts);
}

}  // namespace strainwave::bench
