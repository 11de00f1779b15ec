// SPDX-License-Identifier: Apache-2.0
// Any text as what was measured of a bench; what is accepted, written again, is read as the same.
#include <cstdint>
#include <cstdlib>

#include "bench/configuration/commissioning_file.h"
#include "bench/configuration/read_bench_file.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::bench;
  return CheckText<BenchFileError>(data, size, [](const std::string& text) {
    const auto stops = ParseCommissioningFile(text, "any.yaml");
    if (ParseCommissioningFile(CommissioningText(stops), "written.yaml").size() != stops.size()) std::abort();
  });
}
