// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

#include "protocols/can_frame.h"

namespace strainwave::protocols::canopen {

/// A number as CANopen sends it, lowest byte first (CiA 301, 7.1.4); of at most eight bytes.
constexpr std::uint64_t FromLittleEndian(std::span<const std::uint8_t> bytes) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size() && i < 8; ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
  return value;
}

constexpr void ToLittleEndian(std::uint64_t value, std::span<std::uint8_t> bytes) noexcept {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = i < 8 ? static_cast<std::uint8_t>(value >> (8 * i)) : std::uint8_t{0};
  }
}

/// A data frame of an 11-bit identifier; of more than eight bytes the first eight.
constexpr CanFrame FrameOf(std::uint32_t id, std::span<const std::uint8_t> bytes) noexcept {
  CanFrame frame{.id = id};
  for (const std::uint8_t byte : bytes) {
    if (frame.length < frame.data.size()) frame.data[frame.length++] = byte;
  }
  return frame;
}
constexpr CanFrame FrameOf(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) noexcept {
  return FrameOf(id, std::span(bytes.begin(), bytes.size()));
}

/// Whether the frame carries data under this 11-bit identifier, with a length that a frame can have.
constexpr bool IsDataFrame(const CanFrame& frame, std::uint32_t id) noexcept {
  return frame.id == id && !frame.extended && !frame.remote && !frame.error && frame.length <= 8;
}

}  // namespace strainwave::protocols::canopen
