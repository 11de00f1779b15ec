// SPDX-License-Identifier: Apache-2.0
#include "bench/central/copy_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace strainwave::bench {
namespace {

void AppendEscaped(std::string_view text, std::string& to) {
  for (const char letter : text) {
    switch (letter) {
      case '\\':
        to += "\\\\";
        break;
      case '\t':
        to += "\\t";
        break;
      case '\n':
        to += "\\n";
        break;
      case '\r':
        to += "\\r";
        break;
      default:
        to += letter;
    }
  }
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
    array += '"';
    for (const char letter : ServerText(text)) {
      if (letter == '"' || letter == '\\') array += '\\';
      array += letter;
    }
    array += '"';
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

void CopyText::Separate() {
  if (begun_) rows_ += '\t';
  begun_ = true;
}

CopyText& CopyText::Text(std::string_view text) {
  Separate();
  AppendEscaped(ServerText(text), rows_);
  return *this;
}

CopyText& CopyText::Integer(std::int64_t value) {
  Separate();
  rows_ += std::to_string(value);
  return *this;
}

CopyText& CopyText::Real(std::optional<double> value) {
  if (!value) return Null();
  Separate();
  rows_ += ServerNumber(value);
  return *this;
}

CopyText& CopyText::Truth(bool value) {
  Separate();
  rows_ += value ? 't' : 'f';
  return *this;
}

CopyText& CopyText::Null() {
  Separate();
  rows_ += "\\N";
  return *this;
}

CopyText& CopyText::Reals(std::span<const std::optional<double>> values) {
  Separate();
  rows_ += '{';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) rows_ += ',';
    rows_ += ServerNumber(values[i]);
  }
  rows_ += '}';
  return *this;
}

CopyText& CopyText::Texts(std::span<const std::string> texts) {
  Separate();
  AppendEscaped(ServerArray(texts), rows_);
  return *this;
}

void CopyText::EndRow() {
  rows_ += '\n';
  begun_ = false;
  ++count_;
}

}  // namespace strainwave::bench
