// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>

namespace strainwave::bench {

/// A number as people see it: what is not finite is a dash, in the same width.
struct ShownNumber {
  double value{};
};

template <typename T>
decltype(auto) Shown(const T& value) {
  if constexpr (std::is_floating_point_v<T>) {
    return ShownNumber{value};
  } else {
    return (value);
  }
}

/// As fmt::format, for text that people read: a number that is not there is '–'.
template <typename... T>
std::string Text(fmt::format_string<T...> format, T&&... values) {
  return fmt::vformat(format, fmt::make_format_args(Shown(values)...));
}

/// A to Z as a to z; all else is as it was, letters beyond ASCII, too.
inline std::string LowerCase(std::string_view text) {
  std::string lower(text);
  for (char& letter : lower) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return lower;
}

}  // namespace strainwave::bench

template <>
struct fmt::formatter<strainwave::bench::ShownNumber> : fmt::formatter<double> {
  auto format(const strainwave::bench::ShownNumber& number, fmt::format_context& context) const {
    if (std::isfinite(number.value)) return fmt::formatter<double>::format(number.value, context);
    fmt::memory_buffer buffer;
    fmt::format_context aside(fmt::appender(buffer), context.args(), context.locale());
    fmt::formatter<double>::format(0.0, aside);
    // The dash takes the place of the number; the spaces around it stay.
    const std::string_view word(buffer.data(), buffer.size());
    const std::size_t begin = word.find_first_not_of(' ');
    const std::size_t end = word.find_last_not_of(' ') + 1;
    const std::size_t freed = begin + word.size() - end == 0 ? 0 : end - begin - 1;
    const bool at_left = begin == 0;
    return fmt::format_to(context.out(), "{:{}}–{:{}}", "", at_left ? 0 : begin + freed, "",
                          at_left ? word.size() - end + freed : word.size() - end);
  }
};
