// SPDX-License-Identifier: Apache-2.0
// Any bytes as a TDMS file.
#include <cstdint>

#include "tests/fuzz/import_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ReadAndMap(std::as_bytes(std::span(data, size)), strainwave::daq::ReadTdmsFile);
  return 0;
}
