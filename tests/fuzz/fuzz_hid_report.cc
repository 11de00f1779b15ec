// SPDX-License-Identifier: Apache-2.0
// Any report against any field.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/hid_report.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::protocols;
  constexpr std::size_t kHead = 6;
  if (size < kHead) return 0;
  HidField field;
  field.report_id = data[0];
  field.report_length = data[1];
  field.first_bit = static_cast<unsigned>(data[2] | (data[3] & 7) << 8);
  field.bits = data[4];
  field.is_signed = (data[5] & 1) != 0;
  field.high_byte_first = (data[5] & 2) != 0;
  if (!CheckField(field).empty()) return 0;
  const HidValue value = TakeField(field, {data + kHead, size - kHead});
  const double most = std::ldexp(1.0, static_cast<int>(field.bits));
  const bool fits = field.is_signed ? value.value >= -most / 2 && value.value < most / 2
                                    : value.value >= 0 && value.value < most;
  if (!fits) std::abort();
  return 0;
}
