// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// How large a record may be that somebody hands over, so that time and memory are bounded whatever the file
/// says.
namespace strainwave::daq {

inline constexpr std::size_t kMostColumns = 10'000;   // the largest front ends have 1024 channels
inline constexpr std::size_t kMostMetadata = 10'000;  // lines of a CSV file, attributes of an HDF5 object
inline constexpr std::size_t kMostLine_bytes = std::size_t{1} << 20;  // 10 000 names of 100 letters
inline constexpr std::size_t kMostText_bytes = 2'147'483'647;         // lines are counted in 31 bits
// Of a whole file, 4 GiB as doubles: 1.4 h of four channels at 25.6 kHz.
inline constexpr std::size_t kMostValues = std::size_t{1} << 29;
inline constexpr std::size_t kMostGroups = 100'000;  // of an HDF5 file; a cycle has about ten
inline constexpr int kDeepestGroup = 32;             // groups in one another
// Decoded over stored size of a dataset, above a size that is harmless: measured signals shrink to a tenth.
inline constexpr std::size_t kMostInflation = 100;
inline constexpr std::size_t kHarmless_bytes = std::size_t{64} << 20;

}  // namespace strainwave::daq
