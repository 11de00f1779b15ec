// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "protocols/can_frame.h"

namespace strainwave::protocols::canopen {

/// An emergency message (CiA 301, 7.2.7).
struct Emergency {
  std::uint8_t node_id{};
  std::uint16_t code{};
  std::uint8_t error_register{};  // object 1001h
  std::array<std::uint8_t, 5> vendor_bytes{};

  /// The node takes back what it reported before.
  bool is_reset() const noexcept { return code >> 8 == 0x00; }

  bool operator==(const Emergency&) const = default;
};

/// Nothing for a frame that is not an emergency message of eight bytes under its predefined identifier.
std::optional<Emergency> EmergencyOf(const CanFrame& frame) noexcept;

/// An error code in words, of CiA 301 (7.2.7.1) or CiA 402 (IEC 61800-7-201, object 603Fh): its own, else
/// those of its group, else of its class.
std::string_view ErrorCodeWords(std::uint16_t code) noexcept;

/// "node 3 reports 8611h: following error too large (error register 21h, maker's bytes 01 02 03 04 05)".
std::string Words(const Emergency& emergency);

}  // namespace strainwave::protocols::canopen
