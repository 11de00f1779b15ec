// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "protocols/modbus/register_map.h"

namespace strainwave::protocols::modbus {

/// What one request carries (Modbus Application Protocol V1.1b3, 6.1 to 6.4, 6.11 and 6.12).
inline constexpr int kMostBitsRead = 2000;
inline constexpr int kMostRegistersRead = 125;
inline constexpr int kMostBitsWritten = 1968;
inline constexpr int kMostRegistersWritten = 123;

/// A request without the envelope of its transport (Modbus Application Protocol V1.1b3, 4.1 and 6): function,
/// first address, number of addresses, and for writes the values.
struct Pdu {
  std::array<std::uint8_t, 253> bytes{};
  std::size_t size{};

  std::span<const std::uint8_t> span() const { return std::span(bytes).first(size); }
};

/// Functions 1 to 4. `count` is 1 to 125 registers or 1 to 2000 bits.
/// @throws std::invalid_argument for another count, or one that ends beyond address 65535.
Pdu ReadPdu(Table table, std::uint16_t first, std::uint16_t count);

/// Functions 5 and 6 for one value, 15 and 16 for more: 1 to 123 registers or 1968 bits, one word a bit.
/// @throws std::invalid_argument for another number, or a table that is read-only.
Pdu WritePdu(Table table, std::uint16_t first, std::span<const std::uint16_t> words);

/// What an answer is to a request.
enum class AnswerKind : std::uint8_t {
  kGood,
  kException,      // the device refuses, with a code
  kOtherFunction,  // it answers something else
  kWrongLength,    // more or less data than was asked for
  kOtherAddress,   // a write is confirmed elsewhere, or with another value
};

struct Answer {
  AnswerKind kind{AnswerKind::kGood};
  std::uint8_t exception{};
};

/// Compares an answer with its request and takes the words out of it.
/// @param words  one for each register or bit that was asked for; filled only where the answer is good, and
///   as many as the request counts, or the answer is of a wrong length.
Answer TakeAnswer(const Pdu& request, std::span<const std::uint8_t> answer,
                  std::span<std::uint16_t> words) noexcept;

/// What a device says to a request that has input registers from address 0 on and nothing else: the words, or
/// exception 1 (another function), 2 (no such register) or 3 (no number of registers, or a request of another
/// length).
Pdu AnswerFromInputRegisters(std::span<const std::uint8_t> request, std::span<const std::uint16_t> registers);

/// An exception code in words: "2, illegal data address: …".
std::string ExceptionText(std::uint8_t code);

/// The envelope of Modbus TCP (Messaging on TCP/IP V1.0b, 3.1.3), 7 bytes.
struct Mbap {
  std::uint16_t transaction{};
  std::uint16_t protocol{};  // 0
  std::uint16_t length{};    // of what follows it, unit and PDU
  std::uint8_t unit{};
};
inline constexpr std::size_t kMbapLength = 7;
inline constexpr std::size_t kLongestTcpFrame = kMbapLength + 253;

std::array<std::uint8_t, kMbapLength> MbapBytes(const Mbap& mbap);
/// Nothing when there are fewer than 7 bytes.
std::optional<Mbap> TakeMbap(std::span<const std::uint8_t> frame);

}  // namespace strainwave::protocols::modbus
