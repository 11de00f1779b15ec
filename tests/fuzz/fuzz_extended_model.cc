// SPDX-License-Identifier: Apache-2.0
// Any text as the model that a diagnosis has extended.
// seeds: tests/data/*extended_model*.yaml
// longest: 16384
#include <cstdint>

#include "bench/diagnosis/extended_model.h"
#include "tests/fuzz/file_in_memory.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::bench;
  return CheckText<ModelFileError>(data, size, [](const std::string& text) {
    const FileInMemory file(std::as_bytes(std::span(text)));
    const ExtendedModel model = ReadExtendedModel(file.path());
    (void)NamedCausesOf(model, true);
  });
}
