// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "protocols/can_frame.h"

namespace strainwave::protocols {

/// A frame written as candump prints it: "583#4B41600037020000".
inline CanFrame Frame(const std::string& text) {
  const std::size_t mark = text.find('#');
  CanFrame frame{.id = static_cast<std::uint32_t>(std::stoul(text.substr(0, mark), nullptr, 16))};
  for (std::size_t i = mark + 1; i + 1 < text.size(); i += 2) {
    frame.data[frame.length++] = static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16));
  }
  return frame;
}

inline std::string Text(const CanFrame& frame) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  std::string text;
  for (int shift = 8; shift >= 0; shift -= 4) text += kDigits[frame.id >> shift & 0xF];
  text += '#';
  for (std::size_t i = 0; i < frame.length; ++i) {
    text += kDigits[frame.data[i] >> 4];
    text += kDigits[frame.data[i] & 0xF];
  }
  return text;
}

inline void PrintTo(const CanFrame& frame, std::ostream* out) { *out << Text(frame); }

/// All that `source` has to send now.
template <typename Source, typename Time>
std::vector<std::string> Sent(Source& source, Time now) {
  std::vector<std::string> sent;
  while (const auto frame = source.Poll(now)) sent.push_back(Text(*frame));
  return sent;
}

}  // namespace strainwave::protocols
