// SPDX-License-Identifier: Apache-2.0
#include "daq/history_ring.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace strainwave::daq {

HistoryRing::HistoryRing(std::size_t most_rows, std::size_t width) : most_rows_(most_rows), width_(width) {
  if (most_rows == 0 || width == 0) {
    throw std::invalid_argument(
        fmt::format("most_rows = {} and width = {} are not both above zero", most_rows, width));
  }
  values_.resize(most_rows * width);
}

void HistoryRing::Push(std::span<const double> row) noexcept {
  double* const kept = values_.data() + (pushed_ % most_rows_) * width_;
  const std::size_t given = std::min(row.size(), width_);
  std::copy_n(row.begin(), given, kept);
  std::fill(kept + given, kept + width_, std::numeric_limits<double>::quiet_NaN());
  ++pushed_;
}

std::vector<std::vector<double>> HistoryRing::Unroll() const {
  std::vector<std::vector<double>> columns(width_);
  const std::size_t oldest = pushed_ - rows();
  for (std::size_t channel = 0; channel < width_; ++channel) {
    columns[channel].reserve(rows());
    for (std::size_t row = oldest; row < pushed_; ++row) {
      columns[channel].push_back(values_[(row % most_rows_) * width_ + channel]);
    }
  }
  return columns;
}

}  // namespace strainwave::daq
