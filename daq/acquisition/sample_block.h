// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

namespace strainwave::daq::acquisition {

/// What a device sends: counts of its converter, or values that it scaled itself. Four bytes either way.
enum class SampleType : std::uint8_t { kInt32, kFloat32 };

/// Bits of `BlockHeader::flags`.
enum BlockFlag : std::uint32_t {
  kAfterGap = 1U << 0,        // samples before this block are missing: `lost_before` of them
  kLostIsEstimate = 1U << 1,  // the counter did not say how many; told from the time that went by
  kAfterReset = 1U << 2,      // the device's counter started anew or jumped
  kHadRepeats = 1U << 3,      // samples that had come before were taken off the front
  kDeviceOverrun = 1U << 4,   // the device itself says that it lost samples about here
};

/// All that is known of a block but its samples.
struct BlockHeader {
  std::uint32_t source{};
  std::uint32_t channels{};
  std::uint32_t samples{};  // a channel
  SampleType type{};
  std::uint32_t flags{};
  std::uint64_t device_counter{};  // of the first sample, as the device counts; it may be narrow and wrap
  std::uint64_t first_sample{};    // the same without wraps, from 0; `GapLedger` fills it in
  std::uint64_t lost_before{};     // samples missing between the block before and this one; `GapLedger`
  std::chrono::nanoseconds device_time{};  // of the first sample, by the device's clock
  std::chrono::nanoseconds arrival{};      // when the block was here whole, by the monotonic clock
  double rate_hz{};                        // samples a second and channel, nominal
};

/// A block of samples, sample after sample, of each all channels. All memory is taken when it is made.
class SampleBlock {
 public:
  BlockHeader header{};

  explicit SampleBlock(std::size_t capacity) : words_(capacity) {}

  /// Most values (samples times channels) that fit.
  std::size_t capacity() const { return words_.size(); }
  std::size_t size() const { return std::size_t{header.channels} * header.samples; }

  /// The values as they came, four bytes each in the order of this machine; what they are says `header.type`.
  /// @throws std::length_error if the header asks for more than fits.
  std::span<std::uint32_t> words() { return {words_.data(), CheckedSize()}; }
  std::span<const std::uint32_t> words() const { return {words_.data(), CheckedSize()}; }

  double Value(std::size_t sample, std::size_t channel) const noexcept {
    return ValueOf(words_[sample * header.channels + channel], header.type);
  }
  static double ValueOf(std::uint32_t word, SampleType type) noexcept {
    return type == SampleType::kInt32 ? static_cast<double>(std::bit_cast<std::int32_t>(word))
                                      : static_cast<double>(std::bit_cast<float>(word));
  }

  /// Takes over header and samples of another block without taking memory.
  /// @throws std::length_error if they do not fit.
  void CopyFrom(const SampleBlock& other) {
    const std::span<const std::uint32_t> from = other.words();
    if (from.size() > words_.size()) throw std::length_error("the block does not fit");
    header = other.header;
    std::copy(from.begin(), from.end(), words_.begin());
  }

  /// Takes `samples` off the front; counters and device time go on with the first one that is left.
  void DropFront(std::uint32_t samples) noexcept {
    const std::uint32_t dropped = std::min(samples, header.samples);
    const auto begin = words_.begin() + static_cast<std::ptrdiff_t>(std::size_t{dropped} * header.channels);
    std::copy(begin, words_.begin() + static_cast<std::ptrdiff_t>(size()), words_.begin());
    header.samples -= dropped;
    header.device_counter += dropped;
    header.first_sample += dropped;
    if (header.rate_hz > 0) {
      header.device_time +=
          std::chrono::nanoseconds(static_cast<std::int64_t>(dropped * 1e9 / header.rate_hz));
    }
  }

 private:
  std::size_t CheckedSize() const {
    if (size() > words_.size()) throw std::length_error("a block of samples holds more than it has room for");
    return size();
  }

  std::vector<std::uint32_t> words_;
};

}  // namespace strainwave::daq::acquisition
