// SPDX-License-Identifier: Apache-2.0
#include "daq/import/record_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "daq/csv_text.h"
#include "daq/direction_words.h"
#include "daq/import/units.h"
#include "daq/record_error.h"
#include "daq/record_rules.h"
#include "daq/value_bounds.h"

namespace strainwave::daq {
namespace {

std::string_view NameWithoutUnit(const ForeignChannel& channel) {
  const NamedUnit split = SplitUnit(channel.name);
  return split.name.empty() ? std::string_view(channel.name) : split.name;
}

// As the file says it, in brackets behind the name, or at its end as in torque_Nm.
std::string UnitIn(const ForeignChannel& channel) {
  if (!channel.unit.empty()) return channel.unit;
  if (const std::string_view bracketed = SplitUnit(channel.name).unit; !bracketed.empty())
    return std::string(bracketed);
  const std::size_t path = channel.name.find_last_of("./");
  return std::string(BoundsOf(path == channel.name.npos ? channel.name : channel.name.substr(path + 1)).unit);
}

std::string NamesOf(const ForeignFile& file) {
  constexpr std::size_t kMostNamed = 20;
  std::vector<std::string> names;
  for (const ForeignChannel& channel : file.channels) {
    if (names.size() == kMostNamed) {
      names.push_back(fmt::format("{} more", file.channels.size() - kMostNamed));
      break;
    }
    names.push_back(channel.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

class Mapper {
 public:
  Mapper(ForeignFile file, const RecordMap& map, const std::string& path)
      : file_(std::move(file)), map_(map), path_(path) {}

  Record Map() {
    record_.kind = map_.kind;
    record_.source.file = path_;
    record_.metadata = map_.metadata;
    for (const std::string& note : file_.notes) record_.notes.push_back({0, note});
    if (map_.time) ++uses_left_[&Find(*map_.time)];
    for (const MappedColumn& column : map_.columns) ++uses_left_[&Find(column.source)];
    if (map_.time) AddTime(*map_.time);
    for (const MappedColumn& column : map_.columns) AddColumn(column);
    if (!map_.time) AddRate();
    CheckLengths();
    std::vector<Finding> findings;
    for (const RuleBreak& broken : CheckRecord(record_)) {
      const std::string row = broken.part.level == RecordPart::Level::kCell
                                  ? fmt::format(", value {}", broken.part.row + 1)
                                  : std::string();
      findings.push_back({path_ + row, broken.what, broken.expected});
    }
    if (!findings.empty()) throw RecordError(std::move(findings));
    return std::move(record_);
  }

 private:
  const ForeignChannel& Find(const MapSource& source) const {
    for (const ForeignChannel& channel : file_.channels)
      if (channel.name == source.from) return Whole(channel);
    const ForeignChannel* found = nullptr;
    for (const ForeignChannel& channel : file_.channels) {
      if (NameWithoutUnit(channel) != source.from) continue;
      if (found != nullptr)
        throw RecordError(source.place,
                          fmt::format("'{}' names two channels of {}, '{}' and '{}'", source.from, path_,
                                      found->name, channel.name),
                          "the whole name of one");
      found = &channel;
    }
    if (found == nullptr)
      throw RecordError(source.place, fmt::format("'{}' is no channel of {}", source.from, path_),
                        "one of " + NamesOf(file_));
    return Whole(*found);
  }
  const ForeignChannel& Whole(const ForeignChannel& channel) const {
    if (channel.trouble.empty()) return channel;
    const std::size_t end = channel.trouble.find(": ");
    throw RecordError(channel.trouble.substr(0, end), channel.trouble.substr(end + 2),
                      fmt::format("a value in every row of '{}'", channel.name));
  }

  // Without a second copy, which a long record would hold beside the first.
  std::vector<double> ValuesOf(const ForeignChannel& channel) {
    if (--uses_left_.at(&channel) > 0) return channel.values;
    const auto place = static_cast<std::size_t>(&channel - file_.channels.data());
    return std::move(file_.channels[place].values);
  }

  void Note(std::string text) { record_.notes.push_back({0, std::move(text)}); }

  UnitChange ChangeTo(const std::string& column, const MapSource& source, const ForeignChannel& channel) {
    const std::string target = UnitOf(column);
    const std::string file_unit = UnitIn(channel);
    if (target.empty()) return {};
    if (!source.unit && file_unit.empty()) {
      Note(fmt::format("the unit of '{}' is not said: {} is taken, as {} has it", channel.name, target,
                       column));
      return {};
    }
    const std::string unit = source.unit.value_or(file_unit);
    const std::optional<UnitChange> change = ChangeOfUnit(unit, target);
    if (!change)
      throw RecordError(
          source.unit ? source.place : path_,
          fmt::format("the unit of '{}', {}, does not fit {}", channel.name, Quoted(unit), column),
          UnitsLike(target));
    if (source.unit && !file_unit.empty()) {
      const std::optional<UnitChange> own = ChangeOfUnit(file_unit, target);
      if (!own || own->scale != change->scale || own->offset != change->offset)
        Note(fmt::format("'{}' is in {} by the file and in {} by the map, which counts", channel.name,
                         file_unit, unit));
    }
    return *change;
  }

  void AddTime(const MapSource& source) {
    const ForeignChannel& channel = Find(source);
    if (!channel.words.empty())
      throw RecordError(source.place, fmt::format("'{}' holds words", channel.name),
                        "numbers or times of day");
    const UnitChange change = ChangeTo("time_s", source, channel);
    std::vector<double> time_s = ValuesOf(channel);
    // Times since 1970 leave a double fewer digits than samples need.
    constexpr double kSinceLongAgo_s = 1e8;
    const double start_s =
        time_s.empty() || !(time_s.front() * change.scale > kSinceLongAgo_s) ? 0.0 : time_s.front();
    for (double& value : time_s)
      value = (value - start_s) * change.scale + (start_s == 0.0 ? change.offset : 0.0);
    if (start_s != 0.0)
      Note(fmt::format("time begins at 0, in the file at {} s", ShortestText(start_s * change.scale)));
    record_.SetColumn("time_s", std::move(time_s));
  }

  void AddColumn(const MappedColumn& mapped) {
    if (record_.FindColumn(mapped.column) != nullptr)
      throw RecordError(mapped.source.place, fmt::format("{} is mapped twice", mapped.column), "it once");
    const ForeignChannel& channel = Find(mapped.source);
    if (channel.sample_rate_hz) {
      if (!rate_) rate_ = &channel;
      if (*channel.sample_rate_hz != *rate_->sample_rate_hz)
        throw RecordError(mapped.source.place,
                          fmt::format("'{}' has {} samples a second, '{}' {}", channel.name,
                                      *channel.sample_rate_hz, rate_->name, *rate_->sample_rate_hz),
                          "channels of one rate");
    }
    if (mapped.column == "direction") return AddDirections(mapped, channel);
    if (!channel.words.empty())
      throw RecordError(mapped.source.place, fmt::format("'{}' holds words", channel.name), "numbers");
    const UnitChange change = ChangeTo(mapped.column, mapped.source, channel);
    std::vector<double> values = ValuesOf(channel);
    const double scale = change.scale * mapped.factor;
    const double offset = change.offset * mapped.factor + mapped.offset;
    for (double& value : values) value = value * scale + offset;
    record_.SetColumn(mapped.column, std::move(values));
  }

  void AddDirections(const MappedColumn& mapped, const ForeignChannel& channel) {
    std::vector<Direction> directions;
    for (std::size_t i = 0; i < channel.size(); ++i) {
      const std::string word =
          channel.words.empty() ? ShortestText(channel.values[i] * mapped.factor) : channel.words[i];
      const std::optional<Direction> direction = DirectionOf(word);
      if (!direction)
        throw RecordError(mapped.source.place,
                          fmt::format("value {} of '{}' is {}", i + 1, channel.name, Quoted(word)),
                          std::string(kDirectionWords));
      directions.push_back(*direction);
    }
    record_.columns.push_back({"direction", std::move(directions), "", ""});
  }

  // Evenly sampled channels: a vibration has its rate, any other record its times.
  void AddRate() {
    if (map_.sample_rate_hz && rate_ != nullptr && *map_.sample_rate_hz != *rate_->sample_rate_hz)
      Note(fmt::format("{} has {} samples a second by the file and {} by the map, which counts", rate_->name,
                       *rate_->sample_rate_hz, *map_.sample_rate_hz));
    const std::optional<double> rate_hz = map_.sample_rate_hz ? map_.sample_rate_hz
                                          : rate_ != nullptr  ? rate_->sample_rate_hz
                                                              : std::nullopt;
    if (!rate_hz || record_.FindColumn("time_s") != nullptr) return;
    if (record_.kind == RecordKind::kVibration || record_.kind == RecordKind::kMotor) {
      record_.SetMetadata("sample_rate_hz", *rate_hz);
      return;
    }
    std::vector<double> time_s(record_.rows());
    for (std::size_t i = 0; i < time_s.size(); ++i) time_s[i] = static_cast<double>(i) / *rate_hz;
    record_.SetColumn("time_s", std::move(time_s));
  }

  void CheckLengths() const {
    for (const Column& column : record_.columns) {
      if (column.size() == record_.columns.front().size()) continue;
      throw RecordError(
          path_, fmt::format("{} has {} values", column.name, column.size()),
          fmt::format("{}, as {} has", record_.columns.front().size(), record_.columns.front().name));
    }
  }

  ForeignFile file_;
  std::map<const ForeignChannel*, std::size_t> uses_left_;
  const RecordMap& map_;
  const std::string& path_;
  const ForeignChannel* rate_{};
  Record record_;
};

}  // namespace

Record MapRecord(ForeignFile file, const RecordMap& map, const std::string& path) {
  return Mapper(std::move(file), map, path).Map();
}

std::optional<RecordMap> OwnNames(const ForeignFile& file) {
  RecordMap map;
  for (const auto& [key, value] : file.metadata) {
    const std::size_t slash = key.find_last_of("./");
    const std::string bare = slash == key.npos ? key : key.substr(slash + 1);
    if (bare == "kind") {
      map.kind = RecordKind::Named(value);
    } else {
      map.metadata.emplace_back(bare, value);
    }
  }
  if (map.kind == RecordKind::kUnknown) return std::nullopt;
  for (const ForeignChannel& channel : file.channels) {
    const std::size_t slash = channel.name.find_last_of("./");
    const std::string bare = slash == channel.name.npos ? channel.name : channel.name.substr(slash + 1);
    if (!IsKnownColumn(map.kind, bare) && !TakesFurtherChannels(map.kind)) continue;
    const MapSource source{channel.name, std::nullopt, ""};
    if (bare == "time_s") {
      map.time = source;
    } else {
      map.columns.push_back({bare, source});
    }
  }
  if (map.columns.empty()) return std::nullopt;
  return map;
}

std::vector<std::string> PreviewOf(const ForeignFile& file) {
  std::vector<std::string> lines{
      file.dialect.empty() ? file.format : fmt::format("{}: {}", file.format, fmt::join(file.dialect, ", "))};
  for (const auto& [key, value] : file.metadata) lines.push_back(fmt::format("{} = {}", key, value));
  for (const ForeignChannel& channel : file.channels) {
    std::vector<std::string> first;
    constexpr std::size_t kShown = 3;
    for (std::size_t i = 0; i < std::min(kShown, channel.size()); ++i)
      first.push_back(channel.words.empty() ? fmt::format("{}", channel.values[i]) : channel.words[i]);
    const std::string own = UnitIn(channel);
    const std::string unit = own.empty() ? "no unit" : own;
    const std::string rate = channel.sample_rate_hz
                                 ? fmt::format(", {} samples a second", *channel.sample_rate_hz)
                                 : std::string();
    lines.push_back(fmt::format("'{}': {}{}, {} values: {}{}", channel.name, unit, rate, channel.size(),
                                fmt::join(first, ", "), channel.size() > kShown ? " ..." : ""));
    if (!channel.trouble.empty()) lines.push_back(fmt::format("  but {}", channel.trouble));
  }
  for (const std::string& note : file.notes) lines.push_back(note);
  return lines;
}

}  // namespace strainwave::daq
