// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/row_log.h"

#include <algorithm>

namespace strainwave::bench {

RowLog::RowLog(std::vector<std::string> columns, std::size_t rows)
    : names_(std::move(columns)), columns_(names_.size()), capacity_(rows) {
  for (auto& column : columns_) column.reserve(rows);
}

bool RowLog::Append(std::initializer_list<double> row) noexcept {
  if (rows() >= capacity_ || row.size() != columns_.size()) return false;
  auto value = row.begin();
  for (auto& column : columns_) column.push_back(*value++);
  return true;
}

std::vector<daq::Column> RowLog::Columns(std::span<const std::string> single_precision) const {
  std::vector<daq::Column> taken;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    daq::Column column;
    column.name = names_[i];
    if (std::ranges::find(single_precision, names_[i]) != single_precision.end()) {
      std::vector<float> narrow(columns_[i].size());
      std::ranges::transform(columns_[i], narrow.begin(),
                             [](double value) { return static_cast<float>(value); });
      column.values = std::move(narrow);
    } else {
      column.values = columns_[i];
    }
    taken.push_back(std::move(column));
  }
  return taken;
}

}  // namespace strainwave::bench
