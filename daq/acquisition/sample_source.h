// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daq/acquisition/calibration.h"
#include "daq/acquisition/sample_block.h"

namespace strainwave::daq::acquisition {

/// What is known of a channel's raw values before one is seen, all in counts (or in the unit that a device
/// which scales itself sends). What is not known is not judged.
struct RawLimits {
  std::optional<double> least{};            // below it no honest sensor reads
  std::optional<double> most{};             // above it neither
  std::optional<double> saturation_low{};   // the converter's ends
  std::optional<double> saturation_high{};  //
  double quantum{1};                        // the step between two neighbouring values; 0 if there is none
  double noise{};  // standard deviation with nothing to measure; 0 if it is not known
};

/// One channel of a source. The name ends in the unit of the calibrated value ("accel_x_m_per_s2").
struct ChannelDescription {
  std::string name{};
  std::string unit{};
  std::string sensor_serial{};
  Calibration calibration{};
  RawLimits limits{};
};

struct SourceDescription {
  std::string name{};  // "iio:ip:10.0.0.7/adxl355"
  std::uint32_t source{};
  SampleType type{};
  double rate_hz{};
  unsigned counter_bits{64};             // width of the device's sample counter; 16, 32 or 64
  std::uint32_t most_samples_a_block{};  // no block is longer
  std::vector<ChannelDescription> channels{};
};

/// What `SampleSource::Next` came back with.
enum class NextResult : std::uint8_t {
  kBlock,
  kNothingYet,  // patience ran out; the source lives
  kEnded,       // a record that is replayed is over
  kFailed,      // the device is lost; `trouble()` says why. Calling on may find it again
};

/// A device that gives blocks of samples. `Next` is called from one thread.
class SampleSource {
 public:
  SampleSource() = default;
  SampleSource(const SampleSource&) = delete;
  SampleSource& operator=(const SampleSource&) = delete;
  virtual ~SampleSource() = default;

  /// Connects and starts the flow; `description()` holds from then on.
  /// @throws std::system_error if the device cannot be had, RecordError for a file that cannot be read.
  virtual void Start() = 0;
  virtual void Stop() noexcept = 0;

  /// The next block, waiting for it at most `patience`. `block` has room for the longest one.
  virtual NextResult Next(SampleBlock& block, std::chrono::nanoseconds patience) = 0;

  virtual const SourceDescription& description() const = 0;

  /// The last trouble in words; empty if there was none.
  virtual std::string trouble() const { return {}; }
};

}  // namespace strainwave::daq::acquisition
