// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

/// A file as the program has written it, with bytes changed as the input says: each change is an offset of
/// three bytes, a number of bytes, up to fifteen, and these.
inline std::vector<std::byte> Patched(std::vector<std::byte> file, std::span<const std::uint8_t> input) {
  constexpr std::size_t kHead_bytes = 4;
  constexpr std::size_t kMostAtOnce = 16;
  while (input.size() >= kHead_bytes) {
    const std::size_t offset = input[0] | std::size_t{input[1]} << 8U | std::size_t{input[2]} << 16U;
    const std::size_t count = std::min<std::size_t>(input[3] % kMostAtOnce, input.size() - kHead_bytes);
    for (std::size_t i = 0; i < count; ++i) {
      file[(offset + i) % file.size()] = static_cast<std::byte>(input[kHead_bytes + i]);
    }
    input = input.subspan(kHead_bytes + count);
  }
  return file;
}
