// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace strainwave::daq {

/// CRC-32 of ISO 3309 / ITU-T V.42, the one of zlib, gzip and PNG: "123456789" gives 0xCBF43926.
/// `so_far` is the result for the bytes before, to go on from.
std::uint32_t Crc32(std::span<const std::byte> bytes, std::uint32_t so_far = 0) noexcept;

}  // namespace strainwave::daq
