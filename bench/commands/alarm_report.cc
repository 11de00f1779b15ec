// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/alarm_report.h"

#include <sstream>

#include <fmt/core.h>

#include "bench/campaign/alarms_json.h"
#include "bench/escaped.h"

namespace strainwave::bench {
std::string StateText(const AlarmInstance& instance) {
  const AlarmInstanceState state = instance.state;
  std::string text;
  if (IsShelved(state)) {
    text += fmt::format("shelved until {} by {}, ", ShelfEndUtc(instance.shelf), Escaped(instance.shelf.by));
  }
  if (!instance.returned_utc.empty()) text += fmt::format("returned {}, ", instance.returned_utc);
  text += instance.acknowledged_utc.empty() ? "unacknowledged"
                                            : fmt::format("acknowledged {} by {}", instance.acknowledged_utc,
                                                          Escaped(instance.acknowledged_by));
  if (state == AlarmInstanceState::kLatched || state == AlarmInstanceState::kShelvedLatched) {
    text += ", latched until confirmed";
  }
  if (!instance.confirmed_utc.empty()) {
    text += fmt::format(", confirmed {} by {}", instance.confirmed_utc, Escaped(instance.confirmed_by));
  }
  return text;
}

std::string AlarmText(std::span<const AlarmInstance> instances, std::span<const AlarmRule> rules,
                      std::span<const AlarmAction> actions) {
  std::string text;
  for (const AlarmInstance& instance : instances) {
    std::string counted;
    if (instance.count > 1) {
      counted = fmt::format(", {} raises, the last {}", instance.count, instance.last_raised_utc);
    }
    if (instance.count_in_floods > 0) counted += fmt::format(", {} in a flood", instance.count_in_floods);
    text += fmt::format("  ALARM {} {}{}{}: {}\n    {} {}\n", instance.number, Name(instance.priority),
                        instance.first_out ? ", first out" : "", counted, StateText(instance),
                        instance.raised_utc, instance.text);
    std::istringstream guidance(GuidanceOf(instance.code, rules));
    for (std::string line; std::getline(guidance, line);)
      text += fmt::format("    to do: {}\n", Escaped(line));
    for (const AlarmAction& action : actions) {
      if (action.number != instance.number) continue;
      text += fmt::format("    {} {}{}{}\n", action.utc, action.action,
                          action.by.empty() ? "" : " by " + Escaped(action.by),
                          action.text.empty() ? "" : ": " + Escaped(action.text));
    }
  }
  return text;
}

std::string DocumentOf(const nlohmann::json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace strainwave::bench
