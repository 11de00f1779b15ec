// SPDX-License-Identifier: Apache-2.0
// Any first 64 bits of a sensor's data sheet, and any text in its fields: what is taken is written back
// as the same bits, and reads back from the attributes of a file as the same calibration.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "daq/acquisition/teds.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::daq::acquisition;
  constexpr const char* kNames[] = {"%Sens@Ref",   "%Sign",       "%CalDate",     "%CalPeriod",
                                    "%MinPhysVal", "%MaxPhysVal", "%MinElecVal",  "%MaxElecVal",
                                    "%MapMeth",    "%BridgeType", "%CalInitials", "%Other"};
  if (size < kBasicTeds_bytes) return 0;
  std::array<std::uint8_t, kBasicTeds_bytes> bits{};
  std::copy_n(data, bits.size(), bits.begin());
  BasicTeds basic;
  try {
    basic = BasicTedsFrom(bits);
  } catch (const std::invalid_argument&) {
    return 0;
  }
  if (BytesOf(basic) != bits) std::abort();
  // Fields: which one, its text, a line's end.
  strainwave::daq::Attributes fields;
  for (std::size_t at = bits.size(); at < size;) {
    const std::uint8_t* const end = std::find(data + at + 1, data + size, '\n');
    const auto length = static_cast<std::size_t>(end - (data + at + 1));
    fields.emplace_back(kNames[data[at] % std::size(kNames)],
                        std::string(reinterpret_cast<const char*>(data + at + 1), length));
    at += length + 2;
  }
  try {
    const Calibration calibration = CalibrationFromTeds(basic, fields, 1e4);
    if (!std::isfinite(calibration.sensitivity) || calibration.sensitivity == 0) std::abort();
    if (CalibrationFrom(AttributesOf(calibration)).sensitivity != calibration.sensitivity) std::abort();
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
