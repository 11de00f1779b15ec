// SPDX-License-Identifier: Apache-2.0
#include "daq/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace strainwave::daq {
namespace {

template <typename Value>
std::span<const Value> ValuesOf(const Record& record, std::string_view name, std::string_view type) {
  const Column* column = record.FindColumn(name);
  if (column == nullptr) throw std::invalid_argument(fmt::format("column '{}' is missing", name));
  const auto* values = std::get_if<std::vector<Value>>(&column->values);
  if (values == nullptr) throw std::invalid_argument(fmt::format("column '{}' does not hold {}", name, type));
  return *values;
}

}  // namespace

std::size_t Column::size() const {
  return std::visit([](const auto& held) { return held.size(); }, values);
}

std::size_t Record::rows() const { return columns.empty() ? 0 : columns.front().size(); }

const Column* Record::FindColumn(std::string_view name) const {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [name](const Column& column) { return column.name == name; });
  return found == columns.end() ? nullptr : &*found;
}

std::optional<std::string> Record::Metadata(std::string_view key) const {
  for (const auto& [held_key, value] : metadata) {
    if (held_key == key) return value;
  }
  return std::nullopt;
}

void Record::SetMetadata(std::string_view key, std::string value) {
  for (auto& [held_key, held_value] : metadata) {
    if (held_key == key) {
      held_value = std::move(value);
      return;
    }
  }
  metadata.emplace_back(key, std::move(value));
}

void Record::SetMetadata(std::string_view key, double value) {
  if (!std::isfinite(value)) {
    throw std::invalid_argument(fmt::format("metadata '{}' = {} is not finite", key, value));
  }
  SetMetadata(key, ShortestText(value));
}

void Record::SetColumn(std::string_view name, std::vector<double> values) {
  const auto column = std::ranges::find(columns, name, &Column::name);
  if (column != columns.end()) {
    column->values = std::move(values);
  } else {
    columns.push_back({std::string(name), std::move(values), "", ""});
  }
}

std::span<const double> Record::Doubles(std::string_view column) const {
  return ValuesOf<double>(*this, column, "doubles");
}

std::span<const Direction> Record::Directions(std::string_view column) const {
  return ValuesOf<Direction>(*this, column, "directions");
}

std::vector<double> Record::CopyAsDoubles(std::string_view column) const {
  const Column* found = FindColumn(column);
  if (found != nullptr) {
    if (const auto* floats = std::get_if<std::vector<float>>(&found->values)) {
      return {floats->begin(), floats->end()};
    }
  }
  const std::span<const double> doubles = Doubles(column);
  return {doubles.begin(), doubles.end()};
}

std::string ShortestText(double value) {
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value);
  return {text, end.ptr};
}

std::string ShortestText(float value) {
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value);
  return {text, end.ptr};
}

std::optional<double> NumberFromText(std::string_view text) {
  // std::from_chars knows no plus sign, which spreadsheets and LabVIEW write.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value{};
  const std::from_chars_result end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ptr != text.data() + text.size()) return std::nullopt;
  if (end.ec == std::errc{}) return value;
  if (end.ec != std::errc::result_out_of_range) return std::nullopt;
  // Too small is zero or nearly so; too large is not a number that a double holds.
  value = std::strtod(std::string(text).c_str(), nullptr);
  return std::abs(value) < 1.0 ? std::optional(value) : std::nullopt;
}

}  // namespace strainwave::daq
