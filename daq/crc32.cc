// SPDX-License-Identifier: Apache-2.0
#include "daq/crc32.h"

#include <zlib.h>

namespace strainwave::daq {

std::uint32_t Crc32(std::span<const std::byte> bytes, std::uint32_t so_far) noexcept {
  return static_cast<std::uint32_t>(
      ::crc32_z(so_far, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace strainwave::daq
