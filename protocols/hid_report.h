// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace strainwave::protocols {

/// One number within an input report (Device Class Definition for HID 1.11, 5.6 and 8): value = number ×
/// scale + offset.
struct HidField {
  std::string name;
  std::uint8_t report_id{};     // the report's first byte; 0: the device does not number its reports
  std::size_t report_length{};  // bytes, with the id where there is one
  unsigned first_bit{};         // of the number, counted from the lowest bit of the report's first byte
  unsigned bits{8};             // 1 to 32
  bool is_signed{};
  bool high_byte_first{};  // against the rule of HID; whole bytes only
  double scale{1.0};
  double offset{};
  std::string unit;
  std::optional<double> least, most;  // a value outside is none
};

/// Why a report gives no value.
enum class HidProblem : std::uint8_t { kNone, kOtherReport, kWrongLength, kOutOfRange };

std::string_view Name(HidProblem problem);

struct HidValue {
  double value{};
  HidProblem problem{HidProblem::kNone};
};

/// @param field  one in which `CheckField` finds nothing.
HidValue TakeField(const HidField& field, std::span<const std::uint8_t> report) noexcept;

/// What a field contradicts itself in, as "WHAT (expected …)"; empty when it is sound.
std::string CheckField(const HidField& field);

/// Which keys of a bit set went down, and which came up.
struct KeyChanges {
  std::uint32_t pressed{}, released{};
};
constexpr KeyChanges ChangesOf(std::uint32_t before, std::uint32_t now) {
  return {now & ~before, before & ~now};
}

}  // namespace strainwave::protocols
