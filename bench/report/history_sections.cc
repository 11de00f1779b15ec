// SPDX-License-Identifier: Apache-2.0
#include <map>

#include <fmt/format.h>

#include "bench/report/number_text.h"
#include "bench/report/sections.h"

namespace strainwave::bench {
namespace {

struct Acts {
  int notes{};
  int on_alarms{};
  std::string first_utc;
  std::string last_utc;

  void Count(int& which, const std::string& utc) {
    ++which;
    if (first_utc.empty() || utc < first_utc) first_utc = utc;
    if (utc > last_utc) last_utc = utc;
  }
};

std::string OrDash(const std::string& text) { return text.empty() ? "–" : text; }

std::string BySomebody(const std::string& utc, const std::string& by) {
  return utc.empty() ? "–" : by.empty() ? utc : fmt::format("{} by {}", utc, by);
}

}  // namespace

ReportSection PeopleSection(const CampaignSheet& sheet) {
  std::map<std::string, Acts> people;
  for (const OperatorNote& note : sheet.notes) {
    Acts& acts = people[note.author];
    acts.Count(acts.notes, note.utc);
  }
  for (const AlarmAction& action : sheet.alarm_actions) {
    if (action.by.empty()) continue;
    Acts& acts = people[action.by];
    acts.Count(acts.on_alarms, action.utc);
  }
  ReportSection section{"People and notes", {}};
  if (people.empty()) {
    section.parts.emplace_back("Nobody has signed anything: no note, and nothing done about an alarm.");
    return section;
  }
  ReportTable table{"people", {"who", "notes", "acts on alarms", "first", "last"}, {}};
  for (const auto& [name, acts] : people)
    table.rows.push_back({OrDash(name), std::to_string(acts.notes), std::to_string(acts.on_alarms),
                          acts.first_utc, acts.last_utc});
  section.parts.emplace_back(std::move(table));
  if (sheet.notes.empty()) {
    section.parts.emplace_back("There is no note.");
    return section;
  }
  ReportTable notes{"notes", {"UTC", "who", "note"}, {}};
  for (const OperatorNote& note : sheet.notes)
    notes.rows.push_back({note.utc, OrDash(note.author), note.text});
  section.parts.emplace_back(std::move(notes));
  return section;
}

ReportSection HolesSection(const CampaignSheet& sheet) {
  const schedules::ResumeRules& rules = sheet.inputs.schedule.resume;
  ReportSection section{"Interruptions, and the rule that makes it one test", {}};
  section.parts.emplace_back(
      fmt::format("After a pause of up to {} it counts as the same test; a longer one, or one of unknown "
                  "length, goes on only where a "
                  "person accepts it. After more than {} the gear is warmed up again before anything is "
                  "measured. {} Without a person "
                  "it may go on {} time(s) in a row.",
                  DurationWords(rules.longest_pause_s), DurationWords(rules.re_soak_after_s),
                  rules.operator_acknowledges ? "A person confirms each resumption before anything moves."
                                              : "Nobody is asked before it goes on.",
                  rules.unattended));
  if (sheet.holes.empty()) {
    section.parts.emplace_back("It was never interrupted.");
    return section;
  }
  ReportTable table{"interruptions", {"from UTC", "to UTC", "cycle", "phase", "why", "length by"}, {}};
  for (const Hole& hole : sheet.holes)
    table.rows.push_back({hole.start_utc, OrDash(hole.end_utc), std::to_string(hole.cycle),
                          OrDash(hole.phase), hole.cause, OrDash(hole.clock)});
  section.parts.emplace_back(std::move(table));
  return section;
}

ReportSection SamplesSection(const CampaignSheet& sheet) {
  ReportSection section{"Samples lost", {}};
  if (sheet.samples.empty()) {
    section.parts.emplace_back("No source of this bench counts its samples.");
    return section;
  }
  ReportTable table{"samples", {"source", "received", "lost"}, {}};
  for (const auto& [source, count] : sheet.samples)
    table.rows.push_back({source, fmt::format("{:.0f}", count.received), fmt::format("{:.0f}", count.lost)});
  section.parts.emplace_back("Of all complete cycles.");
  section.parts.emplace_back(std::move(table));
  return section;
}

ReportSection AlarmsSection(const CampaignSheet& sheet) {
  ReportSection section{"Alarms", {}};
  if (sheet.alarms.empty()) {
    section.parts.emplace_back("No alarm was ever raised.");
    return section;
  }
  ReportTable table{"alarms",
                    {"no.", "priority", "raised UTC", "cycle", "what was seen", "raises", "state",
                     "acknowledged", "confirmed"},
                    {}};
  for (const AlarmInstance& alarm : sheet.alarms)
    table.rows.push_back({std::to_string(alarm.number), std::string(Name(alarm.priority)), alarm.raised_utc,
                          std::to_string(alarm.cycle), alarm.text + (alarm.first_out ? " (first out)" : ""),
                          std::to_string(alarm.count), std::string(Words(alarm.state)),
                          BySomebody(alarm.acknowledged_utc, alarm.acknowledged_by),
                          BySomebody(alarm.confirmed_utc, alarm.confirmed_by)});
  section.parts.emplace_back(std::move(table));
  if (sheet.alarm_actions.empty()) {
    section.parts.emplace_back("Nothing was done about any of them.");
    return section;
  }
  ReportTable actions{"alarm_actions", {"no.", "UTC", "who", "what", "words"}, {}};
  for (const AlarmAction& action : sheet.alarm_actions)
    actions.rows.push_back({std::to_string(action.number), action.utc,
                            action.by.empty() ? "by itself" : action.by, action.action, OrDash(action.text)});
  section.parts.emplace_back(std::move(actions));
  return section;
}

ReportSection EventsSection(const CampaignSheet& sheet) {
  ReportSection section{"Events", {}};
  if (sheet.events.empty()) {
    section.parts.emplace_back("The journal has none.");
    return section;
  }
  ReportTable table{"events", {"UTC", "bench time (h)", "cycle", "severity", "event"}, {}};
  for (const Event& event : sheet.events)
    table.rows.push_back({event.utc, fmt::format("{:.4f}", event.time_s / 3600.0),
                          std::to_string(event.cycle), event.severity, event.text});
  section.parts.emplace_back(std::move(table));
  return section;
}

}  // namespace strainwave::bench
