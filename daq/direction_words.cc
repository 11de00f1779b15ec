// SPDX-License-Identifier: Apache-2.0
#include "daq/direction_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "daq/csv_text.h"

namespace strainwave::daq {

std::optional<Direction> DirectionOf(std::string_view text) {
  constexpr std::array<std::string_view, 3> kClockwise{"cw", "forward", "positive"};
  constexpr std::array<std::string_view, 4> kCounterClockwise{"ccw", "backward", "reverse", "negative"};
  std::string plain(Trim(text));
  std::ranges::transform(plain, plain.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::ranges::find(kClockwise, plain) != kClockwise.end()) return Direction::kClockwise;
  if (std::ranges::find(kCounterClockwise, plain) != kCounterClockwise.end())
    return Direction::kCounterClockwise;
  const std::optional<double> value = NumberFromText(plain);
  return value ? DirectionOf(*value) : std::nullopt;
}

std::optional<Direction> DirectionOf(double number) {
  if (number == 1.0) return Direction::kClockwise;
  if (number == -1.0) return Direction::kCounterClockwise;
  return std::nullopt;
}

}  // namespace strainwave::daq
