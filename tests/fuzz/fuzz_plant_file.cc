// SPDX-License-Identifier: Apache-2.0
// Any text as a plant file.
// seeds: bench/examples/*plant*.yaml
// longest: 16384
#include <cstdint>

#include "bench/configuration/read_bench_file.h"
#include "tests/fuzz/file_in_memory.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::bench;
  return CheckText<BenchFileError>(data, size, [](const std::string& text) {
    const FileInMemory file(std::as_bytes(std::span(text)));
    (void)ReadPlantFile(file.path());
  });
}
