// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace strainwave::bench {

/// A segment of vibration as it comes in. Where `trouble` says something, there are no samples.
struct VibrationChunk {
  std::int64_t time_ns{};  // since 1970, UTC: of the first sample
  double sample_rate_hz{};
  std::vector<std::string> channels;
  std::vector<std::vector<double>> samples;  // channels × samples; accelerations in m/s²
  std::vector<double> output_turns;          // turns of the output shaft at each sample; empty: not known
  bool begins_measurement{};                 // the source's own trigger, at the first sample
  bool ends_measurement{};                   // the same, after the last sample
  bool is_counted{};                         // a gap is what `gap` says, and never told from the times
  std::string gap{};                         // what is missing before the first sample; empty: nothing
  std::string origin;                        // where the samples come from, for people
  std::string trouble;                       // "WHAT (what was expected)"
};

/// Where a monitor's vibration comes from: replayed records, a bench, or a device that sends samples.
class VibrationSource {
 public:
  enum class Got { kChunk, kNothingYet, kEnd };

  VibrationSource() = default;
  VibrationSource(const VibrationSource&) = delete;
  VibrationSource& operator=(const VibrationSource&) = delete;
  virtual ~VibrationSource() = default;

  /// Waits for at most `patience` of the world's time. What the source cannot deliver is a chunk with
  /// trouble.
  virtual Got Next(std::chrono::milliseconds patience, VibrationChunk& chunk) = 0;

  /// The time of the stream, which goes on when no samples come; UTC for a live one. From any thread.
  virtual std::int64_t NowNanoseconds() const = 0;
};

}  // namespace strainwave::bench
