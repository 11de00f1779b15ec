// SPDX-License-Identifier: Apache-2.0
// Any text as the profile of a drive.
// seeds: bench/devices/profiles/strainwave_drive.yaml
// longest: 16384
#include <cstdint>

#include "bench/configuration/read_drive_profile.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave;
  return CheckText<bench::BenchFileError>(data, size, [](const std::string& text) {
    (void)bench::ParseDriveProfile(text, "any.yaml", "/nowhere");
  });
}
