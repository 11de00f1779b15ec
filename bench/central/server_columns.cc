// SPDX-License-Identifier: Apache-2.0
#include "bench/central/server_columns.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace strainwave::bench {
namespace {

void AppendQuoted(std::string_view text, std::string& to) {
  to += '"';
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') to += '\\';
    to += letter;
  }
  to += '"';
}

}  // namespace

std::string ServerNumber(std::optional<double> value) {
  if (!value) return "NULL";
  if (std::isnan(*value)) return "NaN";
  if (std::isinf(*value)) return *value > 0.0 ? "Infinity" : "-Infinity";
  return fmt::format("{}", *value);
}

std::string ServerArray(std::span<const std::string> texts) {
  std::string array = "{";
  for (const std::string& text : texts) {
    if (array.size() > 1) array += ',';
    if (text.empty()) {
      array += "NULL";
      continue;
    }
    AppendQuoted(ServerText(text), array);
  }
  return array + '}';
}

std::string ServerText(std::string_view text) {
  const auto is_plain = [](char letter) { return letter > 0; };
  if (std::ranges::all_of(text, is_plain)) return std::string(text);
  const std::string json =
      nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string clean = nlohmann::json::parse(json).get<std::string>();
  for (std::size_t zero = clean.find('\0'); zero != clean.npos; zero = clean.find('\0', zero)) {
    clean.replace(zero, 1, "\uFFFD");
  }
  return clean;
}

std::string& ServerColumns::Next() {
  if (column_ == columns_.size()) columns_.emplace_back();
  std::string& column = columns_[column_++];
  if (count_ > 0) column += ',';
  return column;
}

ServerColumns& ServerColumns::Text(std::string_view text) {
  AppendQuoted(ServerText(text), Next());
  return *this;
}

ServerColumns& ServerColumns::Integer(std::int64_t value) {
  Next() += std::to_string(value);
  return *this;
}

ServerColumns& ServerColumns::Real(std::optional<double> value) {
  Next() += ServerNumber(value);
  return *this;
}

ServerColumns& ServerColumns::Null() {
  Next() += "NULL";
  return *this;
}

ServerColumns& ServerColumns::Reals(std::span<const std::optional<double>> values) {
  std::string array = "{";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) array += ',';
    array += ServerNumber(values[i]);
  }
  AppendQuoted(array + '}', Next());
  return *this;
}

ServerColumns& ServerColumns::Texts(std::span<const std::string> texts) {
  AppendQuoted(ServerArray(texts), Next());
  return *this;
}

void ServerColumns::EndRow() {
  column_ = 0;
  ++count_;
}

std::vector<ServerValue> ServerColumns::After(std::vector<ServerValue> values) const {
  for (const std::string& column : columns_) values.emplace_back('{' + column + '}');
  return values;
}

}  // namespace strainwave::bench
