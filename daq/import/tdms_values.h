// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace strainwave::daq::tdms {

/// Appends `count` numbers as doubles: of a type that `WidthOf` (tdms_types.h) has bytes for, from `first`
/// on, each `stride` bytes behind the one before. All of their bytes are there.
void AppendNumbers(std::uint32_t type, bool big_endian, const char* first, std::size_t stride,
                   std::size_t count, std::vector<double>& values);

}  // namespace strainwave::daq::tdms
