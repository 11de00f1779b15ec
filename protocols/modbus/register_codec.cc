// SPDX-License-Identifier: Apache-2.0
#include "protocols/modbus/register_codec.h"

#include <bit>
#include <cmath>
#include <limits>
#include <optional>

namespace strainwave::protocols::modbus {
namespace {

std::uint16_t Swapped(std::uint16_t word) { return static_cast<std::uint16_t>(word << 8 | word >> 8); }

std::uint16_t InOrder(std::uint16_t word, ByteOrder order) {
  return order == ByteOrder::kHighFirst ? word : Swapped(word);
}

bool WithinLimits(const Register& value, double number) {
  return !(value.least && number < *value.least) && !(value.most && number > *value.most);
}

double RawNumber(ValueType type, std::uint32_t bits) {
  switch (type) {
    case ValueType::kInt16:
      return static_cast<std::int16_t>(bits);
    case ValueType::kUint16:
    case ValueType::kUint32:
      return bits;
    case ValueType::kInt32:
      return static_cast<std::int32_t>(bits);
    case ValueType::kFloat32:
      return std::bit_cast<float>(bits);
    case ValueType::kBit:
      return bits != 0 ? 1.0 : 0.0;
  }
  return 0.0;
}

template <typename Integer>
std::optional<std::uint32_t> Rounded(double raw) {
  const double nearest = std::round(raw);
  if (nearest < static_cast<double>(std::numeric_limits<Integer>::min()) ||
      nearest > static_cast<double>(std::numeric_limits<Integer>::max())) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(nearest));
}

std::optional<std::uint32_t> RawBits(ValueType type, double raw) {
  switch (type) {
    case ValueType::kInt16:
      return Rounded<std::int16_t>(raw);
    case ValueType::kUint16:
      return Rounded<std::uint16_t>(raw);
    case ValueType::kInt32:
      return Rounded<std::int32_t>(raw);
    case ValueType::kUint32:
      return Rounded<std::uint32_t>(raw);
    case ValueType::kFloat32:
      if (std::abs(raw) > static_cast<double>(std::numeric_limits<float>::max())) return std::nullopt;
      return std::bit_cast<std::uint32_t>(static_cast<float>(raw));
    case ValueType::kBit:
      if (raw != 0.0 && raw != 1.0) return std::nullopt;
      return raw != 0.0 ? 1U : 0U;
  }
  return std::nullopt;
}

}  // namespace

std::string_view Name(CodecProblem problem) {
  switch (problem) {
    case CodecProblem::kNone:
      return "none";
    case CodecProblem::kWrongLength:
      return "not as many registers as the type takes";
    case CodecProblem::kNotFinite:
      return "not a finite number";
    case CodecProblem::kOutOfRange:
      return "out of range";
  }
  return "";
}

Decoded Decode(const Register& value, std::span<const std::uint16_t> words) noexcept {
  if (words.size() != static_cast<std::size_t>(Length(value.type))) return {0.0, CodecProblem::kWrongLength};
  std::uint32_t bits = value.type == ValueType::kBit ? words[0] : InOrder(words[0], value.byte_order);
  if (words.size() == 2) {
    const std::uint32_t second = InOrder(words[1], value.byte_order);
    bits = value.word_order == WordOrder::kHighFirst ? bits << 16 | second : second << 16 | bits;
  }
  const double number = RawNumber(value.type, bits) * value.scale + value.offset;
  if (!std::isfinite(number)) return {0.0, CodecProblem::kNotFinite};
  if (!WithinLimits(value, number)) return {number, CodecProblem::kOutOfRange};
  return {number, CodecProblem::kNone};
}

Encoded Encode(const Register& value, double number) noexcept {
  if (!std::isfinite(number)) return {{}, 0, CodecProblem::kNotFinite};
  const std::optional<std::uint32_t> bits =
      WithinLimits(value, number) ? RawBits(value.type, (number - value.offset) / value.scale) : std::nullopt;
  if (!bits) return {{}, 0, CodecProblem::kOutOfRange};
  Encoded encoded;
  encoded.length = static_cast<std::size_t>(Length(value.type));
  if (value.type == ValueType::kBit) {
    encoded.words[0] = static_cast<std::uint16_t>(*bits);
    return encoded;
  }
  const std::uint16_t low = InOrder(static_cast<std::uint16_t>(*bits), value.byte_order);
  const std::uint16_t high = InOrder(static_cast<std::uint16_t>(*bits >> 16), value.byte_order);
  if (encoded.length == 1) {
    encoded.words[0] = low;
  } else {
    const bool high_first = value.word_order == WordOrder::kHighFirst;
    encoded.words = high_first ? std::array{high, low} : std::array{low, high};
  }
  return encoded;
}

}  // namespace strainwave::protocols::modbus
