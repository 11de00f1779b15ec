// SPDX-License-Identifier: Apache-2.0
// Any text as a mapping file.
// seeds: tests/data/*map*.yaml
// longest: 16384
#include <cstdint>

#include "bench/records/map_file.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave;
  return CheckText<bench::MapFileError>(
      data, size, [](const std::string& text) { (void)bench::ParseMapFile(text, "any.yaml"); });
}
