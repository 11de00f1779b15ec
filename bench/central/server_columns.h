// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/central/server.h"

namespace strainwave::bench {

/// Rows as one parameter a column, each an array in PostgreSQL's text form (PostgreSQL 15, 8.15.2): for
/// INSERT ... SELECT FROM unnest($4::integer[], ...). COPY into a temporary table was measured, too:
/// connections are short, and to make that table costs more than a cycle's rows.
class ServerColumns {
 public:
  ServerColumns& Text(std::string_view text);
  ServerColumns& Integer(std::int64_t value);
  /// With as many digits as bring the same bits back; nothing: NULL.
  ServerColumns& Real(std::optional<double> value);
  ServerColumns& Null();
  /// An array of numbers as text: {1.5,NULL}.
  ServerColumns& Reals(std::span<const std::optional<double>> values);
  /// An array of texts as text; an empty one is NULL.
  ServerColumns& Texts(std::span<const std::string> texts);
  void EndRow();

  int count() const { return count_; }
  /// Behind these values, one for each column.
  std::vector<ServerValue> After(std::vector<ServerValue> values) const;

 private:
  std::string& Next();

  std::vector<std::string> columns_;  // without the brackets around them
  std::size_t column_{};
  int count_{};
};

/// A number as PostgreSQL reads it; nothing: NULL.
std::string ServerNumber(std::optional<double> value);
/// {"a","b"}, as PostgreSQL reads an array of texts; an empty one is NULL.
std::string ServerArray(std::span<const std::string> texts);

/// What PostgreSQL takes as text: UTF-8 without the character zero. A journal may hold any bytes; what is
/// none becomes U+FFFD.
std::string ServerText(std::string_view text);

}  // namespace strainwave::bench
