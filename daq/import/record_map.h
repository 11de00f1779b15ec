// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daq/import/foreign_file.h"
#include "daq/record.h"

/// What the series of a foreign file mean (docs/contract.md#files-of-others).
namespace strainwave::daq {

struct MapSource {
  std::string from;                 // the channel's name, with or without its unit in brackets
  std::optional<std::string> unit;  // in place of what the file says
  std::string place{};              // in the mapping file, for messages
};

/// value in the column's unit · factor + offset.
struct MappedColumn {
  std::string column;  // of the record: torque_Nm
  MapSource source;
  double factor{1.0};
  double offset{};
};

struct RecordMap {
  RecordKind kind;
  std::string kind_place{};
  std::optional<MapSource> time{};
  std::optional<double> sample_rate_hz{};  // in place of a time
  std::vector<MappedColumn> columns{};
  std::vector<std::pair<std::string, std::string>> metadata{};
};

/// The record that the map makes of the file. What is taken by default, corrected, or said differently by
/// file and map is a note of the record.
/// @throws RecordError, at the place in the mapping file: a channel that is not there (with those that are),
/// or there twice; a unit that does not fit; series of different lengths; a cell that is no value.
Record MapRecord(ForeignFile file, const RecordMap& map, const std::string& path);

/// The map by which a file is read that names its columns as records do: `time_s`, `torque_Nm`, and has
/// `kind` among its metadata. Nothing where it does not.
std::optional<RecordMap> OwnNames(const ForeignFile& file);

/// What was understood, for people: format, each series with unit, rate and first values, what was left out.
std::vector<std::string> PreviewOf(const ForeignFile& file);

}  // namespace strainwave::daq
