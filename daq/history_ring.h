// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::daq {

/// The last rows of some channels at control rate, kept so that an event arrives with what went before it.
/// All memory is taken when it is made.
class HistoryRing {
 public:
  /// @throws std::invalid_argument if either is zero.
  HistoryRing(std::size_t most_rows, std::size_t width);

  /// Keeps a row of `width()` values and forgets the oldest one when full. A row that is too short is filled
  /// up with NaN, of one that is too long the first `width()` values are kept.
  void Push(std::span<const double> row) noexcept;

  void Clear() noexcept { pushed_ = 0; }

  std::size_t width() const { return width_; }
  std::size_t rows() const { return pushed_ < most_rows_ ? pushed_ : most_rows_; }

  /// One vector a channel, oldest row first: columns as a record holds them.
  std::vector<std::vector<double>> Unroll() const;

 private:
  std::size_t most_rows_;
  std::size_t width_;
  std::vector<double> values_;  // row after row
  std::size_t pushed_{};        // since the start or the last Clear()
};

}  // namespace strainwave::daq
