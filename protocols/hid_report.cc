// SPDX-License-Identifier: Apache-2.0
#include "protocols/hid_report.h"

#include <cmath>

namespace strainwave::protocols {
namespace {

std::uint32_t BitsOf(const HidField& field, std::span<const std::uint8_t> report) {
  std::uint32_t bits = 0;
  if (field.high_byte_first) {
    for (unsigned i = 0; i < field.bits / 8; ++i) bits = bits << 8 | report[field.first_bit / 8 + i];
    return bits;
  }
  for (unsigned i = 0; i < field.bits; ++i) {
    const unsigned at = field.first_bit + i;
    bits |= static_cast<std::uint32_t>(report[at / 8] >> (at % 8) & 1) << i;
  }
  return bits;
}

}  // namespace

std::string_view Name(HidProblem problem) {
  switch (problem) {
    case HidProblem::kNone:
      return "none";
    case HidProblem::kOtherReport:
      return "another report";
    case HidProblem::kWrongLength:
      return "a report of the wrong length";
    case HidProblem::kOutOfRange:
      return "a value out of range";
  }
  return "";
}

HidValue TakeField(const HidField& field, std::span<const std::uint8_t> report) noexcept {
  if (field.report_id != 0 && (report.empty() || report[0] != field.report_id)) {
    return {0.0, HidProblem::kOtherReport};
  }
  if (report.size() != field.report_length || field.first_bit + field.bits > 8 * report.size()) {
    return {0.0, HidProblem::kWrongLength};
  }
  const std::uint32_t bits = BitsOf(field, report);
  const std::int64_t sign = std::int64_t{1} << (field.bits - 1);
  const std::int64_t number = field.is_signed && bits >= sign ? bits - 2 * sign : std::int64_t{bits};
  const double value = static_cast<double>(number) * field.scale + field.offset;
  if ((field.least && value < *field.least) || (field.most && value > *field.most)) {
    return {value, HidProblem::kOutOfRange};
  }
  return {value, HidProblem::kNone};
}

std::string CheckField(const HidField& field) {
  if (field.bits < 1 || field.bits > 32) return "bits is out of range (expected 1 to 32)";
  if (field.first_bit + field.bits > 8 * field.report_length) {
    return "the number ends beyond the report (expected bits within report_length)";
  }
  if (field.report_id != 0 && field.first_bit < 8) {
    return "the number lies over the report's id (expected first_bit of 8 or more)";
  }
  if (field.high_byte_first && (field.first_bit % 8 != 0 || field.bits % 8 != 0)) {
    return "the high byte comes first in a number that is not whole bytes (expected multiples of 8 bits)";
  }
  if (!std::isfinite(field.scale) || field.scale == 0.0 || !std::isfinite(field.offset)) {
    return "scale or offset is not usable (expected finite numbers, the scale not zero)";
  }
  return "";
}

}  // namespace strainwave::protocols
