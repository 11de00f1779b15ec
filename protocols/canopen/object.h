// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>

namespace strainwave::protocols::canopen {

/// Where a value stands in a node's object dictionary (CiA 301, 7.4).
struct ObjectAddress {
  std::uint16_t index{};
  std::uint8_t subindex{};

  auto operator<=>(const ObjectAddress&) const = default;
};

/// Data types of CiA 301, 7.4.7 (Table 44), by the numbers that an EDS file gives them.
enum class DataType : std::uint16_t {
  kBoolean = 0x01,
  kInteger8 = 0x02,
  kInteger16 = 0x03,
  kInteger32 = 0x04,
  kUnsigned8 = 0x05,
  kUnsigned16 = 0x06,
  kUnsigned32 = 0x07,
  kReal32 = 0x08,
  kVisibleString = 0x09,
  kOctetString = 0x0A,
  kUnicodeString = 0x0B,
  kDomain = 0x0F,
  kReal64 = 0x11,
  kInteger64 = 0x15,
  kUnsigned64 = 0x1B,
};

enum class AccessType : std::uint8_t { kReadOnly, kWriteOnly, kReadWrite, kConstant };

}  // namespace strainwave::protocols::canopen
