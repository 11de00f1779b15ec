// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/record_labels.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <variant>
#include <vector>

#include "bench/records/record_refusal.h"

namespace strainwave::bench {
namespace {

std::vector<double> NumbersOf(const daq::Record& record, const std::string& name) {
  const daq::Column* const column = record.FindColumn(name);
  if (column == nullptr || std::holds_alternative<std::vector<daq::Direction>>(column->values)) return {};
  return record.CopyAsDoubles(name);
}

}  // namespace

std::optional<double> LabelOf(const daq::Record& record, const std::string& name) {
  if (const auto text = record.Metadata(name)) {
    const auto value = daq::NumberFromText(*text);
    if (!value || !std::isfinite(*value)) {
      throw RecordRefusal(record, name + " is '" + *text + "' (expected a finite number)");
    }
    return value;
  }
  const std::vector<double> values = NumbersOf(record, name);
  if (values.empty()) return std::nullopt;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::optional<std::string> ClassOf(const daq::Record& record) {
  if (const auto text = record.Metadata("class"); text && !text->empty()) return text;
  const std::vector<double> values = NumbersOf(record, "class");
  if (values.empty()) return std::nullopt;
  if (std::ranges::any_of(values, [&](double value) { return value != values.front(); })) {
    throw RecordRefusal(record, "the column class has several values (expected one class a record)");
  }
  return daq::ShortestText(values.front());
}

}  // namespace strainwave::bench
