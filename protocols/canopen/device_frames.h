// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "protocols/can_frame.h"

namespace strainwave::protocols::canopen::device {

/// A data frame with an 11-bit id; up to 8 bytes.
inline CanFrame DataFrame(std::uint32_t id, std::span<const std::uint8_t> bytes) {
  CanFrame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(std::min(bytes.size(), frame.data.size()));
  std::copy_n(bytes.begin(), frame.length, frame.data.begin());
  return frame;
}

/// Little endian, as everything on CANopen.
inline void PutLittleEndian(std::span<std::uint8_t> bytes, std::uint64_t value) {
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(value & 0xFF);
    value >>= 8;
  }
}

inline std::uint64_t GetLittleEndian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

/// Data of a node in CANopen's sense: neither a remote nor an error frame, and with an 11-bit id.
inline bool IsPlainData(const CanFrame& frame) { return !frame.remote && !frame.error && !frame.extended; }

}  // namespace strainwave::protocols::canopen::device
