// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "daq/acquisition/sample_source.h"

namespace strainwave::daq::acquisition {

/// A source with channels `a_V`, `b_V` ...
inline SourceDescription SourceOf(std::size_t channels, double rate_hz,
                                  SampleType type = SampleType::kFloat32) {
  SourceDescription source{
      .name = "test", .source = 7, .type = type, .rate_hz = rate_hz, .most_samples_a_block = 4096};
  for (std::size_t i = 0; i < channels; ++i) {
    source.channels.push_back({.name = std::string(1, static_cast<char>('a' + i)) + "_V", .unit = "V"});
  }
  return source;
}

/// A block whose first sample has this number, and which comes when its last sample is over.
inline SampleBlock BlockAt(const SourceDescription& source, std::uint64_t number, std::uint32_t samples,
                           const std::function<double(std::uint64_t, std::size_t)>& value) {
  SampleBlock block(source.channels.size() * samples);
  block.header = {.source = source.source,
                  .channels = static_cast<std::uint32_t>(source.channels.size()),
                  .samples = samples,
                  .type = source.type,
                  .device_counter = number,
                  .first_sample = number,
                  .device_time = std::chrono::nanoseconds(
                      std::llround(static_cast<double>(number) * 1e9 / source.rate_hz)),
                  .arrival = std::chrono::nanoseconds(
                      std::llround(static_cast<double>(number + samples) * 1e9 / source.rate_hz)),
                  .rate_hz = source.rate_hz};
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    for (std::size_t channel = 0; channel < source.channels.size(); ++channel) {
      const double number_read = value(number + i, channel);
      block.words()[at++] =
          source.type == SampleType::kInt32
              ? std::bit_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(number_read)))
              : std::bit_cast<std::uint32_t>(static_cast<float>(number_read));
    }
  }
  return block;
}

/// The running number of the sample, so that a reader can tell which one it has.
inline double SampleNumber(std::uint64_t number, std::size_t channel) {
  return static_cast<double>(number % 100000) + 0.25 * static_cast<double>(channel);
}

}  // namespace strainwave::daq::acquisition
