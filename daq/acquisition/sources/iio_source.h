// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daq/acquisition/sample_source.h"
#include "daq/acquisition/spsc_ring.h"

namespace strainwave::daq::acquisition {

struct IioSettings {
  std::string uri{};                    // "local:", "ip:10.0.0.7", as libiio takes it
  std::string device{};                 // name or id, "adxl355"
  std::vector<std::string> channels{};  // ids such as "accel_x"; empty for all that can be scanned
  std::uint32_t samples_a_block{512};
  std::uint32_t source{};
  std::size_t ring_blocks{64};
  std::chrono::milliseconds between_attempts{1000};  // to find a lost device again
};

/// A sensor of the Linux industrial I/O subsystem, on this machine or behind an `iiod`, by libiio: MEMS
/// accelerometers and converters. Counts come as int32, the driver's `scale` and `offset` as calibration, the
/// rate from `sampling_frequency`. A thread of its own refills libiio's buffer.
///
/// IIO has no sample counter. Where the device has a time-stamp channel, that is scanned too, and the counter
/// goes on by its steps, so that what the kernel dropped shows as a gap; without one the counter counts what
/// came, and only what this side drops is known. Stamps are taken from the monotonic clock where the kernel
/// lets us choose (`current_timestamp_clock`); else a date that is set shows as a gap, too.
///
/// A device that is lost is looked for again from within `Next`, which says kFailed once and kNothingYet
/// until it is back; opening it may take longer than the patience. What was lost meanwhile is a gap: by the
/// time stamps, or else by the time that went by.
class IioSource : public SampleSource {
 public:
  explicit IioSource(IioSettings settings);
  ~IioSource() override;

  /// @throws std::system_error if there is no such context, device or channel, a channel has no counts of at
  ///   most 32 bits, no rate can be read, or no buffer can be made; `what()` says which.
  void Start() override;
  void Stop() noexcept override;
  NextResult Next(SampleBlock& block, std::chrono::nanoseconds patience) override;
  const SourceDescription& description() const override { return description_; }
  std::string trouble() const override;

  bool has_time_stamps() const;

 private:
  struct Device;  // libiio's handles
  /// @param before  what the device was like when it was lost.
  void Open(const SourceDescription* before);
  void Recover(std::chrono::nanoseconds patience);
  void Describe();
  void Refill() noexcept;
  void Convert(SampleBlock& block);
  std::uint64_t LostBefore(const BlockHeader& header) const;
  void Fail(std::string why);

  IioSettings settings_;
  SourceDescription description_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<SpscRing<SampleBlock>> ring_;
  std::unique_ptr<SampleBlock> spare_;  // taken where the ring is full, so that the counter goes on
  std::uint64_t counter_{};             // of the next sample
  std::int64_t last_stamp_ns_{};
  std::chrono::nanoseconds last_arrival_{};
  std::chrono::steady_clock::time_point last_attempt_;
  bool failure_told_{};
  bool came_back_{};  // and its next block is the first since
  std::atomic<bool> ends_{false};
  std::atomic<bool> has_failed_{false};
  mutable std::mutex trouble_mutex_;
  std::string trouble_;
  std::thread reader_;
};

}  // namespace strainwave::daq::acquisition
