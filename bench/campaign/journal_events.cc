// SPDX-License-Identifier: Apache-2.0
// Of the journal: events, channels in trouble, holes, calibrations and files; rows with their link in the
// chain.
#include <algorithm>

#include <fmt/core.h>

#include "bench/campaign/journal.h"

namespace strainwave::bench {
namespace {

constexpr std::string_view kChannelTrouble = "channel_trouble/";
constexpr const char* kChannelTroubles = "channel_trouble/*";

std::vector<Event> EventsOf(Statement& statement) {
  std::vector<Event> events;
  while (statement.Step()) {
    events.push_back({statement.Real(0), statement.Text(1), static_cast<int>(statement.Integer(2)),
                      statement.Text(3), statement.Text(4), statement.Text(5), statement.Text(6),
                      statement.Integer(7)});
  }
  return events;
}

}  // namespace

std::int64_t Journal::AddChained(ChainedRow kind, Statement& insert) {
  Savepoint both(database_);
  insert.Run();
  const std::int64_t number = database_.LastInsertId();
  if (is_chained()) AddLink(database_, kind, std::to_string(number));
  both.Release();
  return number;
}

void Journal::AddFile(std::string_view path, const FileDigest& digest) {
  if (!is_chained()) return;
  AddChained(ChainedRow::kFile, database_.Prepare("INSERT INTO files(path, bytes, sha256) VALUES(?, ?, ?)")
                                    .Bind(path)
                                    .Bind(static_cast<std::int64_t>(digest.bytes))
                                    .Bind(std::string_view(digest.sha256)));
}

std::map<std::string, FileDigest> Journal::Files() const {
  std::map<std::string, FileDigest> files;
  if (!HasChain(database_)) return files;
  Statement statement = database_.Prepare("SELECT path, bytes, sha256 FROM files ORDER BY id");
  while (statement.Step()) {
    files[statement.Text(0)] = {static_cast<std::uint64_t>(statement.Integer(1)), statement.Text(2)};
  }
  return files;
}

void Journal::AddEvent(const Event& event) {
  end_.event =
      AddChained(ChainedRow::kEvent, database_
                                         .Prepare("INSERT INTO events(time_s, utc, cycle, phase, severity, "
                                                  "code, text) VALUES(?, ?, ?, ?, ?, ?, ?)")
                                         .Bind(event.time_s)
                                         .Bind(event.utc)
                                         .Bind(event.cycle)
                                         .Bind(event.phase)
                                         .Bind(event.severity)
                                         .Bind(event.code)
                                         .Bind(event.text));
}

std::vector<Event> Journal::Events(int newest) const {
  Statement statement = database_.Prepare(
      "SELECT time_s, utc, cycle, phase, severity, code, text, id FROM events ORDER BY id DESC LIMIT ?");
  statement.Bind(newest);
  return EventsOf(statement);
}

std::optional<Event> Journal::LastEventOfBench() const {
  Statement statement = database_.Prepare(
      "SELECT time_s, utc, cycle, phase, severity, code, text, id FROM events WHERE severity <> 'action' "
      "ORDER "
      "BY id DESC LIMIT 1");
  std::vector<Event> events = EventsOf(statement);
  return events.empty() ? std::nullopt : std::optional(std::move(events.front()));
}

std::vector<Event> Journal::EventsAfter(std::int64_t id, int most) const {
  Statement statement = database_.Prepare(
      "SELECT time_s, utc, cycle, phase, severity, code, text, id FROM events WHERE id > ? ORDER BY id DESC "
      "LIMIT ?");
  statement.Bind(id).Bind(most);
  std::vector<Event> events = EventsOf(statement);
  std::ranges::reverse(events);
  return events;
}

std::vector<Event> Journal::OpenAlarms() const {
  Statement statement = database_.Prepare(
      "SELECT time_s, utc, cycle, phase, severity, code, text, id FROM events WHERE severity = 'alarm' AND "
      "id > "
      "(SELECT COALESCE(MAX(id), 0) FROM events WHERE code IN ('resume', 'completed')) ORDER BY id DESC");
  return EventsOf(statement);
}

// Properties, so that the journals of earlier programs have them, too: none.
void Journal::SetChannelTroubles(const std::vector<ChannelTrouble>& troubles) {
  Transaction transaction(database_);
  database_.Prepare("DELETE FROM campaign WHERE key GLOB ?").Bind(kChannelTroubles).Run();
  for (const ChannelTrouble& trouble : troubles) {
    SetProperty(fmt::format("{}{}", kChannelTrouble, trouble.channel),
                fmt::format("{} {}", trouble.since_utc, trouble.reason));
  }
  transaction.Commit();
}

std::vector<ChannelTrouble> Journal::ChannelTroubles() const {
  Statement statement = database_.Prepare("SELECT key, value FROM campaign WHERE key GLOB ? ORDER BY key");
  statement.Bind(kChannelTroubles);
  std::vector<ChannelTrouble> troubles;
  while (statement.Step()) {
    const std::string value = statement.Text(1);
    const std::size_t space = value.find(' ');
    troubles.push_back(
        {statement.Text(0).substr(kChannelTrouble.size()), value.substr(space + 1), value.substr(0, space)});
  }
  return troubles;
}

void Journal::AddHole(const Hole& hole) {
  AddChained(ChainedRow::kHole, database_
                                    .Prepare("INSERT INTO holes(cycle, phase, time_s, start_utc, end_utc, "
                                             "cause, clock) VALUES(?, ?, ?, ?, ?, "
                                             "?, ?)")
                                    .Bind(hole.cycle)
                                    .Bind(hole.phase)
                                    .Bind(hole.time_s)
                                    .Bind(hole.start_utc)
                                    .Bind(hole.end_utc)
                                    .Bind(hole.cause)
                                    .Bind(hole.clock));
}

std::vector<Hole> Journal::Holes() const {
  Statement statement = database_.Prepare(
      "SELECT cycle, phase, time_s, start_utc, end_utc, cause, clock FROM holes ORDER BY id");
  std::vector<Hole> holes;
  while (statement.Step()) {
    holes.push_back({static_cast<int>(statement.Integer(0)), statement.Text(1), statement.Real(2),
                     statement.Text(3), statement.Text(4), statement.Text(5), statement.Text(6)});
  }
  return holes;
}

void Journal::SetCalibration(const Calibration& calibration, std::string_view utc) {
  database_
      .Prepare(
          "INSERT OR REPLACE INTO calibrations(name, value, standard_error, unit, source, utc) "
          "VALUES(?, ?, ?, ?, ?, ?)")
      .Bind(calibration.name)
      .Bind(calibration.value)
      .Bind(calibration.standard_error)
      .Bind(calibration.unit)
      .Bind(calibration.source)
      .Bind(utc)
      .Run();
}

std::optional<Calibration> Journal::FindCalibration(std::string_view name) const {
  for (Calibration& calibration : CalibrationsLike(name)) {
    if (calibration.name == name) return std::move(calibration);
  }
  return std::nullopt;
}

std::vector<Calibration> Journal::CalibrationsLike(std::string_view prefix) const {
  Statement statement = database_.Prepare(
      "SELECT name, value, standard_error, unit, source FROM calibrations WHERE substr(name, 1, ?) = ? ORDER "
      "BY name");
  statement.Bind(static_cast<std::int64_t>(prefix.size())).Bind(prefix);
  std::vector<Calibration> calibrations;
  while (statement.Step()) {
    calibrations.push_back(
        {statement.Text(0), statement.Real(1), statement.Real(2), statement.Text(3), statement.Text(4)});
  }
  return calibrations;
}

}  // namespace strainwave::bench
