// SPDX-License-Identifier: Apache-2.0
#include "bench/records/map_file.h"

#include <fmt/format.h>

#include "bench/configuration/device_file.h"
#include "daq/record_rules.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {
namespace {

using schedules::Bound;
using schedules::Dimension;
using schedules::Presence;
using schedules::ReadContext;
using schedules::YamlMap;
using schedules::YamlNode;

constexpr schedules::FileKind kMapFile{"mapping", "map: 1"};

daq::MapSource SourceOf(YamlMap& map, std::string_view key, std::string_view file) {
  daq::MapSource source{map.Text(key), std::nullopt, fmt::format("{}:{}:{}", file, map.line(), map.column())};
  if (map.has("unit")) source.unit = map.Text("unit");
  return source;
}

daq::RecordMap ReadMap(const YamlNode& root, std::string_view file, ReadContext& context) {
  YamlMap top(root, context);
  top.Version("map");
  daq::RecordMap map;
  map.kind = daq::RecordKind::Named(top.Text("kind"));
  if (map.kind == daq::RecordKind::kUnknown && !map.kind.name().empty() && !top.is_wrong("kind"))
    top.AddError("kind", fmt::format("kind is {} (expected {})", map.kind.name(), daq::kKnownKinds));
  if (top.has("time")) {
    YamlMap time = top.Map("time", Presence::kRequired);
    map.time = SourceOf(time, "column", file);
    time.Finish();
  }
  map.sample_rate_hz = top.OptionalQuantity("sample_rate", Dimension::kFrequency, Bound::kPositive);
  if (map.time && map.sample_rate_hz)
    top.AddError("sample_rate", "sample_rate stands beside time (expected one of them)");
  for (auto& [name, column] : top.NamedMaps("columns", Presence::kRequired)) {
    daq::MappedColumn mapped{name, SourceOf(column, "from", file)};
    mapped.factor = column.Number("factor", Bound::kNotZero, "1");
    mapped.offset = column.Number("offset", Bound::kAny, "0");
    column.Finish();
    map.columns.push_back(std::move(mapped));
  }
  map.metadata = top.TextMap("metadata");
  top.Finish();
  return map;
}

}  // namespace

daq::RecordMap ReadMapFile(const std::filesystem::path& path) {
  return ParseMapFile(TextOfFile<MapFileError>(path, kMapFile), path.string());
}

daq::RecordMap ParseMapFile(const std::string& text, std::string_view file_name) {
  return ParseFile<MapFileError>(text, file_name, kMapFile, [&](const YamlNode& root, ReadContext& context) {
    return ReadMap(root, file_name, context);
  });
}

}  // namespace strainwave::bench
