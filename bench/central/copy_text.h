// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace strainwave::bench {

/// Rows in the text format of PostgreSQL's COPY (PostgreSQL 15, "COPY", File Formats): columns apart by a
/// tab, rows by a line feed, \N for NULL.
class CopyText {
 public:
  CopyText& Text(std::string_view text);
  CopyText& Integer(std::int64_t value);
  /// With as many digits as bring the same bits back; nothing: NULL.
  CopyText& Real(std::optional<double> value);
  CopyText& Truth(bool value);
  CopyText& Null();
  /// An array of numbers, {1.5,NULL}.
  CopyText& Reals(std::span<const std::optional<double>> values);
  /// An array of texts; an empty one is NULL.
  CopyText& Texts(std::span<const std::string> texts);
  void EndRow();

  const std::string& rows() const { return rows_; }
  int count() const { return count_; }

 private:
  void Separate();

  std::string rows_;
  bool begun_{};  // a row
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
