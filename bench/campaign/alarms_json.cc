// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/alarms_json.h"

#include <cmath>

#include "bench/campaign/campaign_alarms.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

nlohmann::json TextOrNull(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

// What a person may do about it now.
nlohmann::json MayBe(const AlarmInstance& instance) {
  nlohmann::json events = nlohmann::json::array();
  for (const AlarmEvent event : {AlarmEvent::kAcknowledge, AlarmEvent::kConfirm, AlarmEvent::kShelve,
                                 AlarmEvent::kUnshelve, AlarmEvent::kComment}) {
    if (Next(instance.state, event, instance.latching)) events.push_back(Name(event));
  }
  return events;
}

nlohmann::json SignedJson(const std::string& by, const std::string& utc) {
  return utc.empty() ? nlohmann::json() : nlohmann::json{{"by", by}, {"utc", utc}};
}

}  // namespace

std::string ShelfEndUtc(const AlarmShelf& shelf) {
  return UtcText(shelf.utc_ms + std::llround(1e3 * shelf.length_s));
}

nlohmann::json AlarmsJson(std::span<const AlarmInstance> instances, std::span<const AlarmRule> rules,
                          std::span<const AlarmAction> actions) {
  nlohmann::json all = nlohmann::json::array();
  for (const AlarmInstance& instance : instances) {
    nlohmann::json done = nlohmann::json::array();
    for (const AlarmAction& action : actions) {
      if (action.number != instance.number) continue;
      done.push_back(
          {{"utc", action.utc}, {"by", action.by}, {"action", action.action}, {"text", action.text}});
    }
    nlohmann::json shelved;
    if (IsShelved(instance.state)) {
      shelved = {{"by", instance.shelf.by}, {"until_utc", ShelfEndUtc(instance.shelf)}};
    }
    all.push_back({{"number", instance.number},
                   {"code", instance.code},
                   {"text", instance.text},
                   {"cycle", instance.cycle},
                   {"phase", instance.phase},
                   {"priority", Name(instance.priority)},
                   {"latching", instance.latching},
                   {"state", Name(instance.state)},
                   {"active", IsActive(instance.state)},
                   {"first_out", instance.first_out},
                   {"count", instance.count},
                   {"count_in_floods", instance.count_in_floods},
                   {"utc", instance.raised_utc},
                   {"last_raised_utc", instance.last_raised_utc},
                   {"returned_utc", TextOrNull(instance.returned_utc)},
                   {"acknowledged", SignedJson(instance.acknowledged_by, instance.acknowledged_utc)},
                   {"confirmed", SignedJson(instance.confirmed_by, instance.confirmed_utc)},
                   {"shelved", std::move(shelved)},
                   {"guidance", GuidanceOf(instance.code, rules)},
                   {"may", MayBe(instance)},
                   {"actions", std::move(done)}});
  }
  return all;
}

nlohmann::json AlarmListJson(const Journal& journal, std::span<const AlarmRule> rules, bool all,
                             const Moment& now) {
  const AlarmList list = ReadAlarms(journal, all, now);
  return {{"alarms", AlarmsJson(list.alarms, rules, journal.AlarmActions())},
          {"raised_ever", list.raised_ever}};
}

}  // namespace strainwave::bench
