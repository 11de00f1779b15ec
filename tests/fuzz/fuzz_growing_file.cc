// SPDX-License-Identifier: Apache-2.0
// Any bytes in two blocks, whose checksums are right, of a record that was growing when the program died; or
// as the file itself.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "daq/crc32.h"
#include "daq/growing_file.h"
#include "daq/record_error.h"
#include "tests/fuzz/file_in_memory.h"

namespace {

struct Header {
  char magic[8]{'s', 'w', 'r', 'o', 'w', 's', '0', '1'};
  std::uint64_t number{};
  std::uint64_t payload_bytes{};
  std::uint64_t rows{};
  std::uint32_t payload_crc32{};
  std::uint32_t header_crc32{};
};

void AddBlock(std::vector<std::byte>& file, std::uint64_t number, std::span<const std::byte> payload) {
  Header header{
      .number = number, .payload_bytes = payload.size(), .payload_crc32 = strainwave::daq::Crc32(payload)};
  const auto head = std::as_bytes(std::span(&header, 1));
  header.header_crc32 = strainwave::daq::Crc32(head.first(offsetof(Header, header_crc32)));
  file.insert(file.end(), head.begin(), head.end());
  file.insert(file.end(), payload.begin(), payload.end());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::daq;
  if (size == 0) return 0;
  const auto input = std::as_bytes(std::span(data + 1, size - 1));
  std::vector<std::byte> bytes;
  if (data[0] == 0) {
    bytes.assign(input.begin(), input.end());
  } else {
    const std::size_t first = input.size() * data[0] / 255;
    AddBlock(bytes, 1, input.first(first));
    if (first < input.size()) AddBlock(bytes, 2, input.subspan(first));
  }
  const FileInMemory file(bytes);
  try {
    if (ReadGrowingFile(file.path()).lost_bytes > bytes.size()) std::abort();
  } catch (const RecordError&) {
  }
  return 0;
}
