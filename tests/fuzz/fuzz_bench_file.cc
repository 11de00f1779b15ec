// SPDX-License-Identifier: Apache-2.0
// Any text as a bench file, whose other files are not there.
// seeds: bench/examples/*.yaml
// longest: 16384
#include <cstdint>

#include "bench/configuration/read_bench_file.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave;
  return CheckText<bench::BenchFileError>(
      data, size, [](const std::string& text) { (void)bench::ParseBenchFile(text, "any.yaml", "/nowhere"); });
}
