// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocols/can_frame.h"

/// Frames as they stand in the standard's tables and on a technician's screen: "601#40 00 10 00 00 00 00 00".
namespace strainwave::protocols::canopen::device {

inline CanFrame ByHand(std::string_view text) {
  const std::size_t hash = text.find('#');
  CanFrame frame;
  frame.id = static_cast<std::uint32_t>(std::stoul(std::string(text.substr(0, hash)), nullptr, 16));
  std::string digits;
  for (const char c : text.substr(hash + 1)) {
    if (c != ' ') digits += c;
  }
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    frame.data[frame.length++] = static_cast<std::uint8_t>(std::stoul(digits.substr(i, 2), nullptr, 16));
  }
  return frame;
}

inline std::string ByEye(const CanFrame& frame) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (int shift = 8; shift >= 0; shift -= 4) text += kDigits[frame.id >> shift & 0xFU];
  text += '#';
  for (std::size_t i = 0; i < frame.length; ++i) {
    if (i != 0) text += ' ';
    text += kDigits[frame.data[i] >> 4U];
    text += kDigits[frame.data[i] & 0xFU];
  }
  return text;
}

/// What a node has to say, frame after frame, one a line; at most `most`.
template <typename Node>
std::string AllOf(Node& node, int most = 1000) {
  std::string text;
  CanFrame frame;
  for (int i = 0; i < most && node.Next(frame); ++i) {
    if (i != 0) text += '\n';
    text += ByEye(frame);
  }
  return text;
}

}  // namespace strainwave::protocols::canopen::device
