// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/campaign_alarms.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "bench/errors/bench_error.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

constexpr double kAll_s = -std::numeric_limits<double>::infinity();
constexpr double kOpenAlone_s = std::numeric_limits<double>::infinity();

bool IsOverBy(const AlarmInstance& instance, const Moment& now) {
  const AlarmShelf& shelf = instance.shelf;
  return IsShelfOver(instance, PauseBetween({shelf.utc_ms, shelf.since_boot_ms, shelf.boot}, now).length_s);
}

// As TakeOffShelves, and the journal knows.
void EndShelves(Journal& journal, std::vector<AlarmInstance>& instances, const Moment& now) {
  for (AlarmInstance& instance : instances) {
    if (!IsShelved(instance.state) || !IsOverBy(instance, now)) continue;
    Act(instance, AlarmEvent::kShelfOver, "", "");
    journal.StoreAlarm(instance);
    journal.AddAlarmAction(
        {instance.number, UtcText(now.utc_ms), "", std::string(Name(AlarmEvent::kShelfOver)), ""});
  }
}

std::string_view PastOf(AlarmEvent event) {
  switch (event) {
    case AlarmEvent::kAcknowledge:
      return "acknowledged";
    case AlarmEvent::kConfirm:
      return "confirmed";
    case AlarmEvent::kShelve:
      return "shelved";
    case AlarmEvent::kUnshelve:
      return "taken off its shelf";
    case AlarmEvent::kComment:
      return "commented";
    case AlarmEvent::kRaise:
    case AlarmEvent::kReturn:
    case AlarmEvent::kShelfOver:
      break;
  }
  return "changed by a person";
}

std::string_view ExpectedFor(AlarmEvent event) {
  switch (event) {
    case AlarmEvent::kAcknowledge:
      return "one that nobody has acknowledged";
    case AlarmEvent::kConfirm:
      return "one that is latched: returned and acknowledged";
    case AlarmEvent::kShelve:
      return "one that is open and on no shelf";
    case AlarmEvent::kUnshelve:
      return "one that is shelved";
    case AlarmEvent::kComment:
    case AlarmEvent::kRaise:
    case AlarmEvent::kReturn:
    case AlarmEvent::kShelfOver:
      break;
  }
  return "acknowledge, confirm, comment, shelve or unshelve";
}

void DemandShelf(double length_s) {
  if (std::isfinite(length_s) && length_s > 0.0 && length_s <= kLongestShelf_s) return;
  throw BenchError(
      ExitCode::kWrongInput,
      fmt::format("error: an alarm cannot be shelved for {:g} s (expected more than 0 s and at most "
                  "{:g} h)",
                  length_s, kLongestShelf_s / 3600.0));
}

}  // namespace

void TakeOffShelves(std::vector<AlarmInstance>& instances, const Moment& now) {
  for (AlarmInstance& instance : instances) {
    if (IsShelved(instance.state) && IsOverBy(instance, now)) Act(instance, AlarmEvent::kShelfOver, "", "");
  }
}

AlarmList ReadAlarms(const Journal& journal, bool all, const Moment& now) {
  AlarmList list{journal.Alarms(kAll_s)};
  list.raised_ever = list.alarms.size();
  TakeOffShelves(list.alarms, now);
  if (!all) std::erase_if(list.alarms, [](const AlarmInstance& alarm) { return !IsOpen(alarm.state); });
  return list;
}

RaiseResult RaiseAlarm(Journal& journal, std::span<const AlarmRule> rules, AlarmRaise raise,
                       const Moment& now) {
  raise.utc = UtcText(now.utc_ms);
  raise.priority = PriorityOf(raise.code, rules);
  raise.latching = IsLatching(raise.code, rules);
  const ChatterLimits limits;
  std::vector<AlarmInstance> instances =
      journal.Alarms(raise.time_s - std::max(limits.period_s, limits.again_within_s));
  EndShelves(journal, instances, now);
  std::vector<bool> was_first_out;
  for (const AlarmInstance& instance : instances) was_first_out.push_back(instance.first_out);
  const RaiseResult result = Raise(instances, raise, limits);
  for (std::size_t i = 0; i < was_first_out.size(); ++i) {
    if (i != result.index && instances[i].first_out != was_first_out[i]) journal.StoreAlarm(instances[i]);
  }
  journal.StoreAlarm(instances[result.index]);
  return result;
}

void ReturnAlarmsOf(Journal& journal, std::string_view code, double time_s) {
  for (AlarmInstance& instance : journal.Alarms(kOpenAlone_s)) {
    if (instance.code == code && Return(instance, time_s, UtcNow())) journal.StoreAlarm(instance);
  }
}

void ReturnAlarmsOfLastRun(Journal& journal, double time_s) {
  for (AlarmInstance& instance : journal.Alarms(kAll_s)) {
    if (instance.of_earlier_run) continue;
    Return(instance, time_s, UtcNow());
    instance.of_earlier_run = true;
    journal.StoreAlarm(instance);
  }
}

AlarmInstance ActOnAlarm(const CampaignFolder& folder, Journal& journal, const AlarmRequest& request,
                         const Moment& now) {
  if (request.event == AlarmEvent::kShelve) DemandShelf(request.shelf_length_s);
  const std::string utc = UtcText(now.utc_ms);
  Transaction transaction(journal.database());
  std::vector<AlarmInstance> instances = journal.Alarms(kAll_s);
  EndShelves(journal, instances, now);
  const auto found = std::ranges::find(instances, request.number, &AlarmInstance::number);
  if (found == instances.end()) {
    Refuse(folder.root, fmt::format("there is no alarm {}", request.number),
           instances.empty() ? "none: the campaign has had no alarm"
                             : fmt::format("a number from 1 to {}", instances.back().number));
  }
  const AlarmShelf shelf{.by = {},
                         .utc_ms = now.utc_ms,
                         .since_boot_ms = now.since_boot_ms,
                         .boot = now.boot,
                         .length_s = request.shelf_length_s};
  if (!Act(*found, request.event, request.by, utc, shelf)) {
    Refuse(folder.root,
           fmt::format("alarm {} cannot be {}: it is {}", request.number, PastOf(request.event),
                       Words(found->state)),
           std::string(ExpectedFor(request.event)));
  }
  journal.StoreAlarm(*found);
  journal.AddAlarmAction({request.number, utc, request.by, std::string(Name(request.event)), request.text});
  transaction.Commit();
  return *found;
}

}  // namespace strainwave::bench
