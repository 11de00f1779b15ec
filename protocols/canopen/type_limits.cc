// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/type_limits.h"

#include <limits>

#include <fmt/format.h>

#include "protocols/canopen/eds_file.h"

namespace strainwave::protocols::canopen {
namespace {

struct Range {
  std::int64_t low;
  std::int64_t high;
};

Range RangeOf(DataType type) {
  if (type == DataType::kBoolean) return {0, 1};
  const std::size_t bits = 8 * BytesOf(type);
  if (bits == 64) {
    return {IsSignedType(type) ? std::numeric_limits<std::int64_t>::min() : 0,
            std::numeric_limits<std::int64_t>::max()};
  }
  const std::int64_t count = std::int64_t{1} << bits;
  return IsSignedType(type) ? Range{-count / 2, count / 2 - 1} : Range{0, count - 1};
}

}  // namespace

bool IsKnownType(DataType type) {
  switch (type) {
    case DataType::kBoolean:
    case DataType::kInteger8:
    case DataType::kInteger16:
    case DataType::kInteger32:
    case DataType::kUnsigned8:
    case DataType::kUnsigned16:
    case DataType::kUnsigned32:
    case DataType::kReal32:
    case DataType::kVisibleString:
    case DataType::kOctetString:
    case DataType::kUnicodeString:
    case DataType::kDomain:
    case DataType::kReal64:
    case DataType::kInteger64:
    case DataType::kUnsigned64:
      return true;
  }
  return false;
}

bool IsSignedType(DataType type) {
  return type == DataType::kInteger8 || type == DataType::kInteger16 || type == DataType::kInteger32 ||
         type == DataType::kInteger64;
}

bool IsIntegerType(DataType type) {
  return IsKnownType(type) && BytesOf(type) != 0 && type != DataType::kReal32 && type != DataType::kReal64;
}

std::size_t BytesOf(DataType type) {
  switch (type) {
    case DataType::kBoolean:
    case DataType::kInteger8:
    case DataType::kUnsigned8:
      return 1;
    case DataType::kInteger16:
    case DataType::kUnsigned16:
      return 2;
    case DataType::kInteger32:
    case DataType::kUnsigned32:
    case DataType::kReal32:
      return 4;
    case DataType::kInteger64:
    case DataType::kUnsigned64:
    case DataType::kReal64:
      return 8;
    case DataType::kVisibleString:
    case DataType::kOctetString:
    case DataType::kUnicodeString:
    case DataType::kDomain:
      return 0;
  }
  return 0;
}

std::optional<std::int64_t> TypedEdsNumber(std::string_view text, std::uint8_t node_id, DataType type) {
  const std::optional<std::int64_t> number = EdsNumber(text, node_id);
  if (!number) return std::nullopt;
  const Range range = RangeOf(type);
  if (*number >= range.low && *number <= range.high) return number;
  const std::size_t bits = 8 * BytesOf(type);
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (!hexadecimal || !IsSignedType(type) || bits == 64) return std::nullopt;
  const std::int64_t count = std::int64_t{1} << bits;
  if (*number < 0 || *number >= count) return std::nullopt;
  return *number - count;
}

std::string RangeWords(DataType type) {
  const Range range = RangeOf(type);
  return fmt::format("a number from {} to {}", range.low, range.high);
}

}  // namespace strainwave::protocols::canopen
