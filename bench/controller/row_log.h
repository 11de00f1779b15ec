// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "daq/record.h"

namespace strainwave::bench {

/// Rows of a record while it is being taken: memory is set aside before the phase starts, so that appending
/// allocates nothing. One thread appends; others may copy what is there so far.
class RowLog {
 public:
  RowLog(std::vector<std::string> columns, std::size_t rows);

  /// False when the log is full; the row is then not kept.
  bool Append(std::initializer_list<double> row) noexcept;
  std::size_t rows() const noexcept { return rows_.load(std::memory_order_acquire); }
  std::size_t capacity() const noexcept { return capacity_; }

  /// A copy of the columns so far. Columns in `single_precision` are stored as float.
  std::vector<daq::Column> Columns(std::span<const std::string> single_precision = {}) const;

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;  // each of `capacity_` values, of which `rows_` are taken
  std::size_t capacity_;
  std::atomic<std::size_t> rows_{};
};

}  // namespace strainwave::bench
