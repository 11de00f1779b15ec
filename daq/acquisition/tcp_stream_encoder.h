// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "daq/acquisition/sample_source.h"

namespace strainwave::daq::acquisition {

/// The sender's side of `TCP_STREAM.md`: whole messages as bytes.
std::vector<std::byte> EncodeHello(const SourceDescription& description);

/// Counter, device time and samples are those of the block. The bytes replace what `message` held; its memory
/// is used again.
void EncodeBlock(const SampleBlock& block, std::vector<std::byte>& message);

/// @param counter  of the sample that comes next.
std::vector<std::byte> EncodeKeepAlive(std::uint64_t counter, std::chrono::nanoseconds device_time);

}  // namespace strainwave::daq::acquisition
