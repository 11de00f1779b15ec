// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "daq/record_kind.h"

namespace strainwave::daq {

/// Sense of a transmission-error sweep; the numbers are what HDF5 readers may find in place of the text.
enum class Direction : std::int8_t { kCounterClockwise = -1, kClockwise = 1 };

/// One named channel of a record, in the unit that its name ends in ("torque_Nm").
/// `double` for measured slow channels, `float` for fast vibration, `Direction` for the `direction` column.
struct Column {
  using Values = std::variant<std::vector<double>, std::vector<float>, std::vector<Direction>>;

  std::string name;
  Values values;
  std::string sensor_serial;  // empty when the source did not say
  std::string calibration;    // id of the calibration that was applied; empty as above
  /// That calibration as texts by the names of `FORMAT.md` ("sensitivity", "zero", "polynomial"), so that a
  /// later one can take its place; empty where the value is as raw as it gets.
  std::vector<std::pair<std::string, std::string>> calibration_terms{};

  std::size_t size() const;
};

/// Where a record came from, for messages: a CSV line, or an HDF5 group.
struct RecordSource {
  std::string file;
  int first_data_line{};   // 1-based; 0 for HDF5
  std::string group{};     // HDF5 path of the record; empty for CSV
  std::string specimen{};  // of whom all records of an HDF5 file are, by its attribute; may be empty
};

/// What a reader of a record left out, took by default, found odd or corrected, in words.
struct RecordNote {
  int line{};  // of a CSV; 0 where there is none
  std::string text;

  bool operator==(const RecordNote&) const = default;
};

/// One measurement: metadata (text, in file order) and columns of equal length.
/// Field units at this edge: degrees, Nm, s, degC (docs/contract.md#units-and-signs).
struct Record {
  RecordKind kind;
  std::vector<std::pair<std::string, std::string>> metadata;  // without `kind`
  std::vector<Column> columns;
  RecordSource source;
  std::vector<RecordNote> notes{};  // never written to a file

  std::size_t rows() const;
  const Column* FindColumn(std::string_view name) const;
  /// The metadata value as text, or nothing.
  std::optional<std::string> Metadata(std::string_view key) const;
  void SetMetadata(std::string_view key, std::string value);
  void SetMetadata(std::string_view key, double value);  // shortest text that reads back to the same bits;
                                                         // std::invalid_argument if not finite
  /// In the place of the values of the column of that name; a new column, without unit, where there is none.
  void SetColumn(std::string_view name, std::vector<double> values);

  /// @throws std::invalid_argument when the column is missing or holds another type.
  std::span<const double> Doubles(std::string_view column) const;
  std::span<const Direction> Directions(std::string_view column) const;
  /// The same for a column of doubles or floats, as a copy.
  std::vector<double> CopyAsDoubles(std::string_view column) const;
};

/// The shortest text that reads back to the same bits of the type given.
std::string ShortestText(double value);
std::string ShortestText(float value);

/// The number that the whole text is, "nan" and "inf" among them; nothing for any other text.
std::optional<double> NumberFromText(std::string_view text);

}  // namespace strainwave::daq
