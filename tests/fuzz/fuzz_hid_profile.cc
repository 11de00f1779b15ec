// SPDX-License-Identifier: Apache-2.0
// Any text as the file of a HID device.
// seeds: bench/devices/profiles/hid_*.yaml
// longest: 16384
#include <cstdint>

#include "bench/configuration/read_hid_profile.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave;
  return CheckText<bench::HidProfileError>(
      data, size, [](const std::string& text) { (void)bench::ParseHidProfile(text, "any.yaml"); });
}
