// SPDX-License-Identifier: Apache-2.0
// Any text as a CSV record that is replayed.
#include <cstdint>

#include "tests/fuzz/replay_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FileInMemory file(std::as_bytes(std::span(data, size)));
  ReplayToTheEnd(file.path(), 1 + static_cast<std::uint32_t>(size % 7), true);
  return 0;
}
