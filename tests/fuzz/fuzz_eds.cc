// SPDX-License-Identifier: Apache-2.0
// Any text as an electronic data sheet, and each of its values as a number of any node.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "protocols/canopen/eds_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::protocols::canopen;
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  EdsNumber(text, data[0]);
  try {
    for (const auto& [address, object] : ParseEds(text, "any.eds").objects) {
      EdsNumber(object.default_value, data[0]);
      EdsNumber(object.low_limit, data[0]);
      EdsNumber(object.high_limit, data[0]);
    }
  } catch (const std::runtime_error& error) {
    // Every finding names its place.
    if (!std::string_view(error.what()).starts_with("any.eds:")) std::abort();
  }
  return 0;
}
