// SPDX-License-Identifier: Apache-2.0
// The HDF5 file of the numbers of a predictor, with any bytes changed.
// longest: 512
#include <cstdint>
#include <cstdlib>

#include "daq/arrays_file.h"
#include "daq/record_error.h"
#include "tests/fuzz/file_in_memory.h"
#include "tests/fuzz/folder_in_memory.h"
#include "tests/fuzz/patched_file.h"

namespace {

using namespace strainwave::daq;

std::vector<std::byte> AFile(const FolderInMemory& folder) {
  WriteArraysAtomically(folder.path() / "made.h5",
                        {.attributes = {{"format", "1"}},
                         .arrays = {{"members", {2, 3}, {1, 2, 3, 4, 5, 6}}, {"scale", {2}, {1, 2}}}});
  return folder.Read("made.h5");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::byte> made = AFile(FolderInMemory());
  const FileInMemory file(Patched(made, {data, size}));
  try {
    for (const NamedArray& array : ReadArrays(file.path()).arrays) {
      std::size_t count = 1;
      for (const std::size_t extent : array.shape) count *= extent;
      if (count != array.values.size()) std::abort();
    }
  } catch (const RecordError& error) {
    if (error.findings().empty()) std::abort();
  }
  return 0;
}
