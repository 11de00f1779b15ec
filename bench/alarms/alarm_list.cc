// SPDX-License-Identifier: Apache-2.0
#include "bench/alarms/alarm_list.h"

#include <algorithm>
#include <cmath>

namespace strainwave::bench {
namespace {

bool IsWithin(double earlier_s, double later_s, double period_s) { return later_s - earlier_s <= period_s; }

// The earliest of an upset keeps the mark, in whatever order the raises come.
void MarkFirstOut(std::vector<AlarmInstance>& instances, std::size_t raised, double time_s) {
  bool first = true;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    AlarmInstance& other = instances[i];
    if (i == raised || !other.first_out || other.of_earlier_run) continue;
    if (std::abs(other.last_raised_s - time_s) > kFirstOutWindow_s) continue;
    if (other.last_raised_s <= time_s) {
      first = false;
    } else {
      other.first_out = false;
    }
  }
  instances[raised].first_out = first;
}

struct Choice {
  std::optional<std::size_t> index;
  RaiseEffect effect{RaiseEffect::kNew};
};

// The instance that the raise is to be counted on; none: it makes a new one.
Choice Choose(const std::vector<AlarmInstance>& instances, const AlarmRaise& raise,
              const ChatterLimits& limits) {
  std::optional<std::size_t> newest;
  std::optional<std::size_t> open;
  int of_a_kind = 0;
  int of_all = 0;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const AlarmInstance& instance = instances[i];
    const bool recent = IsWithin(instance.raised_s, raise.time_s, limits.period_s);
    of_all += recent ? 1 : 0;
    if (instance.code != raise.code || instance.of_earlier_run) continue;
    newest = i;
    of_a_kind += recent ? 1 : 0;
    if (IsOpen(instance.state)) open = i;
    if (IsActive(instance.state)) return {i, RaiseEffect::kStillActive};
    if (IsShelved(instance.state)) return {i, RaiseEffect::kShelved};
  }
  if (!newest) return {};
  const bool again = IsWithin(instances[*newest].returned_s, raise.time_s, limits.again_within_s);
  if (again || of_a_kind >= limits.most_of_a_kind) return {newest, RaiseEffect::kChatter};
  if (of_all >= limits.most_of_all && open) return {open, RaiseEffect::kFlood};
  return {};
}

}  // namespace

RaiseResult Raise(std::vector<AlarmInstance>& instances, const AlarmRaise& raise,
                  const ChatterLimits& limits) {
  const auto [index, effect] = Choose(instances, raise, limits);
  if (index) {
    AlarmInstance& instance = instances[*index];
    instance.state = *Next(instance.state, AlarmEvent::kRaise, instance.latching);
    ++instance.count;
    if (effect == RaiseEffect::kFlood) ++instance.count_in_floods;
    if (effect != RaiseEffect::kStillActive) {
      MarkFirstOut(instances, *index, raise.time_s);
      instance.returned_s = 0.0;
      instance.returned_utc.clear();
      instance.confirmed_by.clear();
      instance.confirmed_utc.clear();
    }
    if (!IsAcknowledged(instance.state)) {
      instance.acknowledged_by.clear();
      instance.acknowledged_utc.clear();
    }
    instance.last_raised_s = raise.time_s;
    instance.last_raised_utc = raise.utc;
    return {*index, effect};
  }
  AlarmInstance made;
  made.code = raise.code;
  made.text = raise.text;
  made.cycle = raise.cycle;
  made.phase = raise.phase;
  made.priority = raise.priority;
  made.latching = raise.latching;
  made.raised_s = raise.time_s;
  made.last_raised_s = raise.time_s;
  made.raised_utc = raise.utc;
  made.last_raised_utc = raise.utc;
  instances.push_back(std::move(made));
  MarkFirstOut(instances, instances.size() - 1, raise.time_s);
  return {instances.size() - 1, RaiseEffect::kNew};
}

bool Return(AlarmInstance& instance, double time_s, std::string_view utc) {
  const auto next = Next(instance.state, AlarmEvent::kReturn, instance.latching);
  if (!next) return false;
  instance.state = *next;
  instance.returned_s = time_s;
  instance.returned_utc = utc;
  return true;
}

bool Act(AlarmInstance& instance, AlarmEvent event, std::string_view by, std::string_view utc,
         const AlarmShelf& shelf) {
  const auto next = Next(instance.state, event, instance.latching);
  if (!next) return false;
  instance.state = *next;
  switch (event) {
    case AlarmEvent::kAcknowledge:
      instance.acknowledged_by = by;
      instance.acknowledged_utc = utc;
      break;
    case AlarmEvent::kConfirm:
      instance.confirmed_by = by;
      instance.confirmed_utc = utc;
      break;
    case AlarmEvent::kShelve:
      instance.shelf = shelf;
      instance.shelf.by = by;
      break;
    case AlarmEvent::kUnshelve:
    case AlarmEvent::kShelfOver:
      instance.shelf = {};
      break;
    case AlarmEvent::kRaise:
    case AlarmEvent::kReturn:
    case AlarmEvent::kComment:
      break;
  }
  if (!IsShelved(instance.state)) instance.shelf = {};
  return true;
}

bool IsShelfOver(const AlarmInstance& instance, std::optional<double> elapsed_s) {
  return IsShelved(instance.state) && (!elapsed_s || *elapsed_s >= instance.shelf.length_s);
}

}  // namespace strainwave::bench
