// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "protocols/modbus/register_map.h"

namespace strainwave::protocols::modbus {

/// Why a number on the wire is no value, or a value does not fit the wire.
enum class CodecProblem : std::uint8_t {
  kNone,
  kWrongLength,  // other than the registers that the type takes
  kNotFinite,
  kOutOfRange,  // outside the register's own limits, or what its type can hold
};

std::string_view Name(CodecProblem problem);

struct Decoded {
  double value{};
  CodecProblem problem{CodecProblem::kNone};
};

/// The value that `words` stand for, in the register's unit. A bit is 0 or 1.
Decoded Decode(const Register& value, std::span<const std::uint16_t> words) noexcept;

struct Encoded {
  std::array<std::uint16_t, 2> words{};
  std::size_t length{};
  CodecProblem problem{CodecProblem::kNone};

  std::span<const std::uint16_t> span() const { return std::span(words).first(length); }
};

/// The words for a value in the register's unit, rounded to the nearest that integers can hold. A value that
/// does not fit is never cut off: it is a problem, and there are no words.
Encoded Encode(const Register& value, double number) noexcept;

}  // namespace strainwave::protocols::modbus
