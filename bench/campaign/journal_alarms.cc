// SPDX-License-Identifier: Apache-2.0
// Of the journal: alarm instances, what was done about them, and notes of people.
#include <algorithm>

#include <fmt/core.h>

#include "bench/campaign/journal.h"

namespace strainwave::bench {
namespace {

constexpr const char* kAlarmTables = R"sql(
CREATE TABLE alarms(number INTEGER PRIMARY KEY, code TEXT NOT NULL, text TEXT NOT NULL, cycle INTEGER NOT NULL,
  phase TEXT NOT NULL, priority TEXT NOT NULL, latching INTEGER NOT NULL, state TEXT NOT NULL,
  first_out INTEGER NOT NULL, count INTEGER NOT NULL, count_in_floods INTEGER NOT NULL, raised_s REAL NOT NULL,
  last_raised_s REAL NOT NULL, returned_s REAL NOT NULL, raised_utc TEXT NOT NULL, last_raised_utc TEXT NOT NULL,
  returned_utc TEXT NOT NULL, acknowledged_by TEXT NOT NULL, acknowledged_utc TEXT NOT NULL,
  confirmed_by TEXT NOT NULL, confirmed_utc TEXT NOT NULL, shelved_by TEXT NOT NULL, shelved_utc_ms INTEGER NOT NULL,
  shelved_since_boot_ms INTEGER NOT NULL, shelved_boot INTEGER NOT NULL, shelf_length_s REAL NOT NULL,
  of_earlier_run INTEGER NOT NULL);
CREATE TABLE alarm_actions(id INTEGER PRIMARY KEY, number INTEGER NOT NULL REFERENCES alarms(number),
  utc TEXT NOT NULL, author TEXT NOT NULL, action TEXT NOT NULL, text TEXT NOT NULL);
)sql";

constexpr const char* kColumns =
    "number, code, text, cycle, phase, priority, latching, state, first_out, count, count_in_floods, "
    "raised_s, "
    "last_raised_s, returned_s, raised_utc, last_raised_utc, returned_utc, acknowledged_by, "
    "acknowledged_utc, "
    "confirmed_by, confirmed_utc, shelved_by, shelved_utc_ms, shelved_since_boot_ms, shelved_boot, "
    "shelf_length_s, of_earlier_run";

AlarmInstance InstanceOf(const Statement& row) {
  AlarmInstance instance;
  instance.number = row.Integer(0);
  instance.code = row.Text(1);
  instance.text = row.Text(2);
  instance.cycle = static_cast<int>(row.Integer(3));
  instance.phase = row.Text(4);
  // A name that a later program has written: what asks for attention most.
  instance.priority = AlarmPriorityNamed(row.Text(5)).value_or(AlarmPriority::kHigh);
  instance.latching = row.Integer(6) != 0;
  instance.state = AlarmStateNamed(row.Text(7)).value_or(AlarmInstanceState::kRaised);
  instance.first_out = row.Integer(8) != 0;
  instance.count = static_cast<int>(row.Integer(9));
  instance.count_in_floods = static_cast<int>(row.Integer(10));
  instance.raised_s = row.Real(11);
  instance.last_raised_s = row.Real(12);
  instance.returned_s = row.Real(13);
  instance.raised_utc = row.Text(14);
  instance.last_raised_utc = row.Text(15);
  instance.returned_utc = row.Text(16);
  instance.acknowledged_by = row.Text(17);
  instance.acknowledged_utc = row.Text(18);
  instance.confirmed_by = row.Text(19);
  instance.confirmed_utc = row.Text(20);
  instance.shelf = {row.Text(21), row.Integer(22), row.Integer(23),
                    static_cast<std::uint64_t>(row.Integer(24)), row.Real(25)};
  instance.of_earlier_run = row.Integer(26) != 0;
  return instance;
}

}  // namespace

bool Journal::HasAlarms() const {
  Statement statement =
      database_.Prepare("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = 'alarms'");
  return statement.Step();
}

void Journal::AddAlarmTables() {
  if (HasAlarms()) return;
  Transaction transaction(database_);
  // Another program may have been quicker.
  if (!HasAlarms()) {
    std::vector<AlarmInstance> open = AlarmsOfEvents();
    database_.Execute(kAlarmTables);
    for (AlarmInstance& instance : open) StoreAlarm(instance);
  }
  transaction.Commit();
}

std::vector<AlarmInstance> Journal::AlarmsOfEvents() const {
  std::vector<AlarmInstance> instances;
  std::vector<Event> events = OpenAlarms();
  std::ranges::reverse(events);
  for (const Event& event : events) {
    const AlarmKind kind = KindOf(event.code);
    AlarmInstance instance;
    instance.code = event.code;
    instance.text = event.text;
    instance.cycle = event.cycle;
    instance.phase = event.phase;
    instance.priority = kind.priority;
    instance.latching = kind.latching;
    instance.raised_s = instance.last_raised_s = event.time_s;
    instance.raised_utc = instance.last_raised_utc = event.utc;
    instances.push_back(std::move(instance));
  }
  return instances;
}

std::vector<AlarmInstance> Journal::Alarms(double since_s) const {
  if (!HasAlarms()) {
    std::vector<AlarmInstance> open = AlarmsOfEvents();
    for (std::size_t i = 0; i < open.size(); ++i) open[i].number = static_cast<std::int64_t>(i) + 1;
    return open;
  }
  Statement statement = database_.Prepare(fmt::format(
      "SELECT {} FROM alarms WHERE state <> 'cleared' OR raised_s >= ? OR returned_s >= ? ORDER BY "
      "number",
      kColumns));
  statement.Bind(since_s).Bind(since_s);
  std::vector<AlarmInstance> instances;
  while (statement.Step()) instances.push_back(InstanceOf(statement));
  return instances;
}

void Journal::StoreAlarm(AlarmInstance& instance) {
  std::string places = "?";
  for (const char* column = kColumns; *column != '\0'; ++column) {
    if (*column == ',') places += ", ?";
  }
  Statement statement =
      database_.Prepare(fmt::format("INSERT OR REPLACE INTO alarms({}) VALUES({})", kColumns, places));
  if (instance.number > 0) {
    statement.Bind(instance.number);
  } else {
    statement.BindNull();
  }
  statement.Bind(std::string_view(instance.code))
      .Bind(std::string_view(instance.text))
      .Bind(instance.cycle)
      .Bind(std::string_view(instance.phase))
      .Bind(Name(instance.priority))
      .Bind(instance.latching ? 1 : 0)
      .Bind(Name(instance.state))
      .Bind(instance.first_out ? 1 : 0)
      .Bind(instance.count)
      .Bind(instance.count_in_floods)
      .Bind(instance.raised_s)
      .Bind(instance.last_raised_s)
      .Bind(instance.returned_s)
      .Bind(std::string_view(instance.raised_utc))
      .Bind(std::string_view(instance.last_raised_utc))
      .Bind(std::string_view(instance.returned_utc))
      .Bind(std::string_view(instance.acknowledged_by))
      .Bind(std::string_view(instance.acknowledged_utc))
      .Bind(std::string_view(instance.confirmed_by))
      .Bind(std::string_view(instance.confirmed_utc))
      .Bind(std::string_view(instance.shelf.by))
      .Bind(instance.shelf.utc_ms)
      .Bind(instance.shelf.since_boot_ms)
      .Bind(static_cast<std::int64_t>(instance.shelf.boot))
      .Bind(instance.shelf.length_s)
      .Bind(instance.of_earlier_run ? 1 : 0)
      .Run();
  if (instance.number == 0) instance.number = database_.LastInsertId();
}

void Journal::AddAlarmAction(const AlarmAction& action) {
  AddChained(
      ChainedRow::kAlarmAction,
      database_.Prepare("INSERT INTO alarm_actions(number, utc, author, action, text) VALUES(?, ?, ?, ?, ?)")
          .Bind(action.number)
          .Bind(std::string_view(action.utc))
          .Bind(std::string_view(action.by))
          .Bind(std::string_view(action.action))
          .Bind(std::string_view(action.text)));
}

std::vector<AlarmAction> Journal::AlarmActions() const {
  if (!HasAlarms()) return {};
  Statement statement =
      database_.Prepare("SELECT number, utc, author, action, text FROM alarm_actions ORDER BY id");
  std::vector<AlarmAction> actions;
  while (statement.Step()) {
    actions.push_back(
        {statement.Integer(0), statement.Text(1), statement.Text(2), statement.Text(3), statement.Text(4)});
  }
  return actions;
}

void Journal::AddOperatorNote(const OperatorNote& note) {
  AddChained(ChainedRow::kNote,
             database_.Prepare("INSERT INTO operator_notes(utc, author, text) VALUES(?, ?, ?)")
                 .Bind(std::string_view(note.utc))
                 .Bind(std::string_view(note.author))
                 .Bind(std::string_view(note.text)));
}

std::vector<OperatorNote> Journal::OperatorNotes(int newest) const {
  Statement statement =
      database_.Prepare("SELECT utc, author, text FROM operator_notes ORDER BY id DESC LIMIT ?");
  statement.Bind(newest);
  std::vector<OperatorNote> notes;
  while (statement.Step()) {
    notes.push_back({statement.Text(0), statement.Text(1), statement.Text(2)});
  }
  return notes;
}

}  // namespace strainwave::bench
