// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace strainwave::protocols {

/// Bits of an id that is not extended (ISO 11898-1).
inline constexpr std::uint32_t kStandardIdBits = 0x7FF;

/// One classical CAN frame, or what the controller has to say of the bus (ISO 11898-1; error frames as Linux
/// reports them). Data beyond `length` is zero, so that two equal frames compare equal.
struct CanFrame {
  std::uint32_t id{};  // 11 bits, or 29 when extended; of an error frame its class bits
  bool extended{};
  bool remote{};          // a request without data
  bool error{};           // reported by the controller, not sent by a node
  std::uint8_t length{};  // 0 to 8
  std::array<std::uint8_t, 8> data{};

  bool operator==(const CanFrame&) const = default;
};

}  // namespace strainwave::protocols
