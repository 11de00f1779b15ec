// SPDX-License-Identifier: Apache-2.0
#include "bench/alarms/alarm_rules.h"

#include <algorithm>

namespace strainwave::bench {
namespace {

const AlarmRule* FindRule(std::string_view code, std::span<const AlarmRule> rules) {
  const auto rule = std::ranges::find(rules, code, &AlarmRule::code);
  return rule == rules.end() ? nullptr : &*rule;
}

}  // namespace

std::string_view Name(AlarmPriority priority) {
  switch (priority) {
    case AlarmPriority::kLow:
      return "low";
    case AlarmPriority::kMedium:
      return "medium";
    case AlarmPriority::kHigh:
      return "high";
  }
  return "";
}

std::optional<AlarmPriority> AlarmPriorityNamed(std::string_view name) {
  for (const AlarmPriority priority : {AlarmPriority::kLow, AlarmPriority::kMedium, AlarmPriority::kHigh}) {
    if (Name(priority) == name) return priority;
  }
  return std::nullopt;
}

AlarmKind KindOf(std::string_view code) {
  const auto* const kind = std::ranges::find(kAlarmKinds, code, &AlarmKind::code);
  return kind == kAlarmKinds.end() ? AlarmKind{code, AlarmPriority::kMedium, false} : *kind;
}

AlarmPriority PriorityOf(std::string_view code, std::span<const AlarmRule> rules) {
  const AlarmRule* const rule = FindRule(code, rules);
  return rule != nullptr && rule->priority ? *rule->priority : KindOf(code).priority;
}

bool IsLatching(std::string_view code, std::span<const AlarmRule> rules) {
  const AlarmRule* const rule = FindRule(code, rules);
  return rule != nullptr && rule->latching ? *rule->latching : KindOf(code).latching;
}

std::string GuidanceOf(std::string_view code, std::span<const AlarmRule> rules) {
  const AlarmRule* const rule = FindRule(code, rules);
  return rule == nullptr ? std::string() : rule->guidance;
}

}  // namespace strainwave::bench
