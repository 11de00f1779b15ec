// SPDX-License-Identifier: Apache-2.0
// Any text as a maker's EDS or DCF file, made into the draft of a profile: one that has nothing to be filled
// in is read; the others are refused where it is to be filled in.
// seeds: bench/devices/profiles/*.eds
// longest: 16384
#include <cstdint>

#include "bench/configuration/drive_profile_draft.h"
#include "bench/configuration/read_drive_profile.h"
#include "protocols/canopen/eds_file.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave;
  try {
    const auto eds = protocols::canopen::ParseEds({reinterpret_cast<const char*>(data), size}, "any.eds");
    const std::string text = bench::DraftDriveProfile(eds, "any.eds").text;
    return CheckText<bench::BenchFileError>(
        reinterpret_cast<const std::uint8_t*>(text.data()), text.size(),
        [](const std::string& draft) { (void)bench::ParseDriveProfile(draft, "draft.yaml", "/nowhere"); });
  } catch (const std::runtime_error&) {
    return 0;
  }
}
