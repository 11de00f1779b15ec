// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "bench/escaped.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

constexpr std::array kKinds{
    std::pair{NoticeKind::kAlarm, std::string_view("alarm")},
    std::pair{NoticeKind::kEscalation, std::string_view("escalation")},
    std::pair{NoticeKind::kCleared, std::string_view("cleared")},
    std::pair{NoticeKind::kFault, std::string_view("fault")},
    std::pair{NoticeKind::kStopped, std::string_view("stopped")},
    std::pair{NoticeKind::kComplete, std::string_view("complete")},
    std::pair{NoticeKind::kSilence, std::string_view("silence")},
    std::pair{NoticeKind::kSpokeAgain, std::string_view("spoke_again")},
    std::pair{NoticeKind::kSummary, std::string_view("summary")},
    std::pair{NoticeKind::kTest, std::string_view("test")},
};
constexpr std::array kAudiences{
    std::pair{Audience::kFirst, std::string_view("first")},
    std::pair{Audience::kSecond, std::string_view("second")},
    std::pair{Audience::kBoth, std::string_view("both")},
};

template <typename Enum, std::size_t N>
std::string_view NameIn(const std::array<std::pair<Enum, std::string_view>, N>& names, Enum value) {
  return std::ranges::find(names, value, &std::pair<Enum, std::string_view>::first)->second;
}

// Read from a file that anybody may have changed.
template <typename Enum, std::size_t N>
Enum NamedIn(const std::array<std::pair<Enum, std::string_view>, N>& names, const std::string& name) {
  const auto found = std::ranges::find(names, name, &std::pair<Enum, std::string_view>::second);
  if (found == names.end()) throw std::invalid_argument("there is no " + name + " among notices");
  return found->first;
}

AlarmPriority PriorityNamed(const std::string& name) {
  const auto priority = AlarmPriorityNamed(name);
  if (!priority) throw std::invalid_argument("there is no priority " + name);
  return *priority;
}

}  // namespace

std::string_view NameOf(NoticeKind kind) { return NameIn(kKinds, kind); }

NoticedAlarm NoticedOf(const AlarmInstance& instance) {
  return {instance.number, instance.code,  instance.text,      instance.priority,
          instance.cycle,  instance.phase, instance.raised_utc};
}

nlohmann::json NoticeJson(const Notice& notice) {
  nlohmann::json alarms = nlohmann::json::array();
  for (const NoticedAlarm& alarm : notice.alarms) {
    alarms.push_back({{"number", alarm.number},
                      {"code", alarm.code},
                      {"text", Escaped(alarm.text)},
                      {"priority", Name(alarm.priority)},
                      {"cycle", alarm.cycle},
                      {"phase", alarm.phase},
                      {"raised_utc", alarm.raised_utc}});
  }
  return {{"notice", 1},
          {"id", notice.id},
          {"kind", NameOf(notice.kind)},
          {"priority", Name(notice.priority)},
          {"audience", NameIn(kAudiences, notice.audience)},
          {"utc", UtcText(notice.utc_ms)},
          {"utc_ms", notice.utc_ms},
          {"campaign", Escaped(notice.campaign)},
          {"specimen", Escaped(notice.specimen)},
          {"state", notice.state},
          {"subject", notice.subject},
          {"text", notice.text},
          {"alarms", std::move(alarms)},
          {"further", notice.further}};
}

Notice NoticeFrom(const nlohmann::json& json) {
  Notice notice;
  json.at("id").get_to(notice.id);
  notice.kind = NamedIn(kKinds, json.at("kind").get<std::string>());
  notice.priority = PriorityNamed(json.at("priority").get<std::string>());
  notice.audience = NamedIn(kAudiences, json.at("audience").get<std::string>());
  json.at("utc_ms").get_to(notice.utc_ms);
  json.at("campaign").get_to(notice.campaign);
  json.at("specimen").get_to(notice.specimen);
  json.at("state").get_to(notice.state);
  json.at("subject").get_to(notice.subject);
  json.at("text").get_to(notice.text);
  json.at("further").get_to(notice.further);
  for (const nlohmann::json& entry : json.at("alarms")) {
    NoticedAlarm alarm;
    entry.at("number").get_to(alarm.number);
    entry.at("code").get_to(alarm.code);
    entry.at("text").get_to(alarm.text);
    alarm.priority = PriorityNamed(entry.at("priority").get<std::string>());
    entry.at("cycle").get_to(alarm.cycle);
    entry.at("phase").get_to(alarm.phase);
    entry.at("raised_utc").get_to(alarm.raised_utc);
    notice.alarms.push_back(std::move(alarm));
  }
  return notice;
}

}  // namespace strainwave::bench
