// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <cstdint>

#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/sample_block.h"
#include "daq/hdf5_handle.h"

/// The tables beside the samples of a stream file, row by row (`daq/FORMAT.md`, "A stream").
namespace strainwave::daq::acquisition {

struct BlockRow {
  std::uint64_t row;  // of /samples, where the block begins
  std::uint64_t first_sample;
  std::uint64_t device_counter;
  std::uint64_t lost_before;
  std::int64_t device_time_ns;
  std::int64_t arrival_ns;
  std::uint32_t samples;
  std::uint32_t flags;
};

struct GapRow {
  std::uint64_t row;  // of /samples, the one after the gap
  std::uint64_t first_lost;
  std::uint64_t lost;
  std::int64_t last_arrival_ns;
  std::int64_t arrival_ns;
  std::int64_t last_device_time_ns;
  std::int64_t device_time_ns;
  std::uint8_t is_exact;
  std::uint8_t is_reset;
};

BlockRow RowOf(const BlockHeader& header, std::uint64_t row);
GapRow RowOf(const Gap& gap, std::uint64_t row);

/// How a row lies in memory; `packed` as it lies in the file, little-endian and without holes.
/// @throws Hdf5Error.
Hdf5Handle BlockRowType(bool packed);
Hdf5Handle GapRowType(bool packed);

}  // namespace strainwave::daq::acquisition
