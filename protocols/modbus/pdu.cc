// SPDX-License-Identifier: Apache-2.0
#include "protocols/modbus/pdu.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace strainwave::protocols::modbus {
namespace {

constexpr std::uint8_t kExceptionBit = 0x80;
constexpr std::uint16_t kCoilOn = 0xFF00;

std::uint8_t ReadFunction(Table table) {
  switch (table) {
    case Table::kCoil:
      return 1;
    case Table::kDiscrete:
      return 2;
    case Table::kHolding:
      return 3;
    case Table::kInput:
      return 4;
  }
  return 0;
}

void Append(Pdu& pdu, std::uint8_t byte) { pdu.bytes[pdu.size++] = byte; }

void AppendWord(Pdu& pdu, unsigned word) {
  Append(pdu, static_cast<std::uint8_t>(word >> 8));
  Append(pdu, static_cast<std::uint8_t>(word));
}

std::uint16_t WordAt(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

void CheckCount(int first, std::size_t count, int most) {
  if (count < 1 || count > static_cast<std::size_t>(most) || first + static_cast<int>(count) > kAddresses) {
    throw std::invalid_argument(
        fmt::format("count = {} at address {} is out of range (expected 1 to {}, up to address 65535)", count,
                    first, most));
  }
}

std::size_t BytesOfBits(std::size_t count) { return (count + 7) / 8; }

AnswerKind TakeRead(std::uint8_t function, std::size_t count, std::span<const std::uint8_t> answer,
                    std::span<std::uint16_t> words) {
  const bool bits = function <= 2;
  const std::size_t bytes = bits ? BytesOfBits(count) : 2 * count;
  if (answer.size() != 2 + bytes || answer[1] != bytes || words.size() != count) {
    return AnswerKind::kWrongLength;
  }
  for (std::size_t i = 0; i < count; ++i) {
    words[i] =
        bits ? static_cast<std::uint16_t>(answer[2 + i / 8] >> (i % 8) & 1) : WordAt(answer, 2 + 2 * i);
  }
  return AnswerKind::kGood;
}

}  // namespace

Pdu ReadPdu(Table table, std::uint16_t first, std::uint16_t count) {
  CheckCount(first, count, IsBits(table) ? kMostBitsRead : kMostRegistersRead);
  Pdu pdu;
  Append(pdu, ReadFunction(table));
  AppendWord(pdu, first);
  AppendWord(pdu, count);
  return pdu;
}

Pdu WritePdu(Table table, std::uint16_t first, std::span<const std::uint16_t> words) {
  const bool bits = IsBits(table);
  if (table == Table::kInput || table == Table::kDiscrete) {
    throw std::invalid_argument("table is read-only (expected the coil or holding table)");
  }
  CheckCount(first, words.size(), bits ? kMostBitsWritten : kMostRegistersWritten);
  Pdu pdu;
  if (words.size() == 1) {
    Append(pdu, bits ? 5 : 6);
    AppendWord(pdu, first);
    AppendWord(pdu, !bits ? words[0] : words[0] != 0 ? kCoilOn : 0);
    return pdu;
  }
  Append(pdu, bits ? 15 : 16);
  AppendWord(pdu, first);
  AppendWord(pdu, static_cast<unsigned>(words.size()));
  Append(pdu, static_cast<std::uint8_t>(bits ? BytesOfBits(words.size()) : 2 * words.size()));
  if (bits) {
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (i % 8 == 0) Append(pdu, 0);
      if (words[i] != 0) pdu.bytes[pdu.size - 1] |= static_cast<std::uint8_t>(1U << (i % 8));
    }
  } else {
    for (const std::uint16_t word : words) AppendWord(pdu, word);
  }
  return pdu;
}

Answer TakeAnswer(const Pdu& request, std::span<const std::uint8_t> answer,
                  std::span<std::uint16_t> words) noexcept {
  constexpr std::size_t kWriteAnswer = 5;
  if (answer.empty()) return {AnswerKind::kWrongLength};
  const std::uint8_t function = request.bytes[0];
  if (answer[0] == (function | kExceptionBit)) {
    if (answer.size() != 2) return {AnswerKind::kWrongLength};
    return {AnswerKind::kException, answer[1]};
  }
  if (answer[0] != function) return {AnswerKind::kOtherFunction};
  if (function <= 4) return {TakeRead(function, WordAt(request.span(), 3), answer, words)};
  if (answer.size() != kWriteAnswer) return {AnswerKind::kWrongLength};
  const bool same = std::ranges::equal(answer, request.span().first(kWriteAnswer));
  return {same ? AnswerKind::kGood : AnswerKind::kOtherAddress};
}

Pdu AnswerFromInputRegisters(std::span<const std::uint8_t> request,
                             std::span<const std::uint16_t> registers) {
  constexpr std::size_t kReadRequest = 5;
  Pdu answer;
  const std::uint8_t function = request.empty() ? 0 : request[0];
  const auto refuse = [&](std::uint8_t exception) {
    Append(answer, function | kExceptionBit);
    Append(answer, exception);
    return answer;
  };
  if (function != ReadFunction(Table::kInput)) return refuse(1);
  if (request.size() != kReadRequest) return refuse(3);
  const std::size_t first = WordAt(request, 1);
  const std::size_t count = WordAt(request, 3);
  if (count < 1 || count > kMostRegistersRead) return refuse(3);
  if (first + count > registers.size()) return refuse(2);
  Append(answer, function);
  Append(answer, static_cast<std::uint8_t>(2 * count));
  for (const std::uint16_t word : registers.subspan(first, count)) AppendWord(answer, word);
  return answer;
}

std::string ExceptionText(std::uint8_t code) {
  switch (code) {
    case 1:
      return "1, illegal function: the device does not know this kind of request";
    case 2:
      return "2, illegal data address: the device has no such register";
    case 3:
      return "3, illegal data value: the device takes no such value or number of registers";
    case 4:
      return "4, device failure: it could not do what was asked";
    case 5:
      return "5, acknowledged: the device is still working on it";
    case 6:
      return "6, device busy: ask again later";
    case 8:
      return "8, memory parity error in the device";
    case 10:
      return "10, gateway path unavailable: the gateway is set up wrongly or overloaded";
    case 11:
      return "11, no answer from the device behind the gateway";
    default:
      return fmt::format("{}, a code that the standard does not have", code);
  }
}

std::array<std::uint8_t, kMbapLength> MbapBytes(const Mbap& mbap) {
  const auto high = [](std::uint16_t word) { return static_cast<std::uint8_t>(word >> 8); };
  const auto low = [](std::uint16_t word) { return static_cast<std::uint8_t>(word); };
  return {high(mbap.transaction),
          low(mbap.transaction),
          high(mbap.protocol),
          low(mbap.protocol),
          high(mbap.length),
          low(mbap.length),
          mbap.unit};
}

std::optional<Mbap> TakeMbap(std::span<const std::uint8_t> frame) {
  if (frame.size() < kMbapLength) return std::nullopt;
  return Mbap{WordAt(frame, 0), WordAt(frame, 2), WordAt(frame, 4), frame[6]};
}

}  // namespace strainwave::protocols::modbus
