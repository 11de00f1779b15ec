// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "daq/acquisition/sample_block.h"

namespace strainwave::daq::acquisition {

/// Moments of a channel as its values pass, none of them kept. Numerically stable over any length (updates of
/// Pebay, Sandia report SAND2008-6212), and two segments can be put together.
class RunningStatistics {
 public:
  /// All that is known of the values: enough to go on from, in a file or another program.
  struct Moments {
    double count{};
    double mean{};
    double second{}, third{}, fourth{};  // central moments, divided by the count
    double least{}, most{};
  };

  RunningStatistics() = default;
  /// As if the values of these moments had been added.
  explicit RunningStatistics(const Moments& moments) noexcept;
  /// All zero without a value.
  Moments moments() const noexcept;

  /// A value that is not finite is counted and left out.
  void Add(double value) noexcept;
  /// As if all that `other` has seen had been added.
  void Merge(const RunningStatistics& other) noexcept;

  std::uint64_t count() const { return count_; }
  std::uint64_t not_finite() const { return not_finite_; }
  // NaN where there are no values; kurtosis and crest factor also where nothing moves.
  double mean() const;
  double variance() const;  // of these values: divided by their number
  double rms() const;
  double least() const;
  double most() const;
  double peak() const;          // largest magnitude
  double crest_factor() const;  // peak over RMS
  double kurtosis() const;      // 3 for normal noise; bearing damage raises it

 private:
  std::uint64_t count_{};
  std::uint64_t not_finite_{};
  double mean_{};
  double m2_{}, m3_{}, m4_{};  // sums of powers of the distance from the mean
  double least_{}, most_{};
};

/// Adds each channel's samples to its statistics. @throws std::invalid_argument if their numbers differ.
void AddBlock(const SampleBlock& block, std::span<RunningStatistics> channels);

}  // namespace strainwave::daq::acquisition
