// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/random_bytes.h"

#include <openssl/rand.h>

#include <stdexcept>

#include <fmt/format.h>

namespace strainwave::bench {

std::vector<unsigned char> RandomBytes(std::size_t count) {
  std::vector<unsigned char> bytes(count);
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    throw std::runtime_error("the system has no random numbers");
  }
  return bytes;
}

std::string HexOf(std::span<const unsigned char> bytes) {
  return fmt::format("{:02x}", fmt::join(bytes, ""));
}

}  // namespace strainwave::bench
