// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daq/acquisition/sample_source.h"

namespace strainwave::daq::acquisition {

/// What can be wrong with a channel, the worst last.
enum class SensorFault : std::uint8_t {
  kNone,
  kTimeSteps,   // the device's time does not go on as its samples do
  kFlat,        // less noise than the sensor has with nothing to measure: a cable off, an amplifier dead
  kOutOfRange,  // where no honest sensor reads
  kSaturated,   // at an end of the converter
  kStuck,       // one value for longer than noise allows
  kNotFinite,
  kSilent,  // nothing comes
};

/// What a channel's description lets the watch judge within two seconds.
struct WatchAbility {
  std::uint64_t stuck_after{};  // samples of one value; 0: a quiet sensor may read so for longer
  std::uint64_t
      flat_window{};    // samples over which the noise is measured; 0: its noise is not known or too small
  double flat_below{};  // standard deviation in counts
};

/// Finds sensors that give values but not those of what they should measure. Works on raw values, knows
/// nothing of the quantity, and judges only by what the channel's description says (`RawLimits`), so that a
/// quiet sensor is not blamed for its silence:
/// - stuck wants `noise` of at least a third of `quantum`, else equal neighbours say nothing;
/// - flat wants `noise` of at least half a `quantum`;
/// - saturated and out of range want their limits; three samples in a row count, two do not.
/// A fault lasts until the channel was good for a second.
class SensorWatch {
 public:
  /// @throws std::invalid_argument if the rate is not above zero.
  explicit SensorWatch(const SourceDescription& source);

  /// Takes a block's samples, in their order. No memory is taken.
  void Judge(const SampleBlock& block) noexcept;
  /// Also called while nothing comes; `now` is of the monotonic clock that arrivals are told in.
  void Tick(std::chrono::nanoseconds now) noexcept;

  SensorFault fault(std::size_t channel) const { return channels_[channel].fault; }
  bool is_good() const;
  const WatchAbility& ability(std::size_t channel) const { return channels_[channel].ability; }

  /// "accel_x_m_per_s2 (sensor 0815) is stuck: 137 for 0.52 s" or nothing for a good channel.
  std::string ReasonOf(std::size_t channel) const;
  /// What cannot be judged of a channel, in words, for a report at the start; empty if all can.
  std::string BlindSpotsOf(std::size_t channel) const;

 private:
  struct Channel {
    WatchAbility ability;
    SensorFault fault{SensorFault::kNone};
    double evidence{};      // the value, deviation or step that the fault was told by
    double good_samples{};  // in a row
    std::uint64_t same{};   // samples in a row with the last value
    std::uint64_t saturated{};
    std::uint64_t outside{};
    std::uint32_t last_word{};
    bool has_last{};
    std::uint64_t in_window{};
    double window_mean{};
    double window_squares{};
    bool is_flat{};
    double deviation{};
  };
  SensorFault FaultOf(Channel& channel, const RawLimits& limits, std::uint32_t word,
                      double value) const noexcept;
  void Measure(Channel& channel, double value) const noexcept;
  void Raise(Channel& channel, SensorFault fault, double evidence) noexcept;
  bool TimeSteps(const BlockHeader& header, double& step_s) noexcept;

  SourceDescription source_;
  std::vector<Channel> channels_;
  std::chrono::nanoseconds last_arrival_{};
  bool has_arrived_{};
  std::optional<BlockHeader> last_;
};

}  // namespace strainwave::daq::acquisition
