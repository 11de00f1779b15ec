// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/row_log.h"

#include <algorithm>

namespace strainwave::bench {

RowLog::RowLog(std::vector<std::string> columns, std::size_t rows)
    : names_(std::move(columns)), columns_(names_.size(), std::vector<double>(rows)), capacity_(rows) {}

bool RowLog::Append(std::initializer_list<double> row) noexcept {
  const std::size_t at = rows_.load(std::memory_order_relaxed);
  if (at >= capacity_ || row.size() != columns_.size()) return false;
  auto value = row.begin();
  for (auto& column : columns_) column[at] = *value++;
  rows_.store(at + 1, std::memory_order_release);
  return true;
}

std::vector<daq::Column> RowLog::Columns(std::span<const std::string> single_precision) const {
  const std::size_t taken_rows = rows();
  std::vector<daq::Column> taken;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const std::span<const double> values(columns_[i].data(), taken_rows);
    daq::Column column;
    column.name = names_[i];
    if (std::ranges::find(single_precision, names_[i]) != single_precision.end()) {
      std::vector<float> narrow(values.size());
      std::ranges::transform(values, narrow.begin(), [](double value) { return static_cast<float>(value); });
      column.values = std::move(narrow);
    } else {
      column.values = std::vector<double>(values.begin(), values.end());
    }
    taken.push_back(std::move(column));
  }
  return taken;
}

}  // namespace strainwave::bench
