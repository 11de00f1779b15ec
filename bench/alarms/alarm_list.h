// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/alarms/alarm_rules.h"
#include "bench/alarms/alarm_state.h"

namespace strainwave::bench {

/// Of a shelf: when it began, on both clocks of the machine (`Moment`), and for how long.
struct AlarmShelf {
  std::string by{};
  std::int64_t utc_ms{};
  std::int64_t since_boot_ms{};
  std::uint64_t boot{};
  double length_s{};
};

/// One alarm: raised once, and ended by its own return and acknowledgement, whatever becomes of others of
/// its kind. Times in seconds are bench time, which never goes back; UTC is for people.
struct AlarmInstance {
  std::int64_t number{};  // as the journal has it, from 1; 0: not stored yet
  std::string code{};     // of its kind
  std::string text{};     // what was seen when it was first raised
  int cycle{};
  std::string phase{};
  AlarmPriority priority{AlarmPriority::kMedium};
  bool latching{};
  AlarmInstanceState state{AlarmInstanceState::kRaised};
  bool first_out{};       // nothing else was raised in the second before it
  int count{1};           // raises
  int count_in_floods{};  // of those that a flood has added to it
  double raised_s{};
  double last_raised_s{};
  double returned_s{};  // where it has returned
  std::string raised_utc{};
  std::string last_raised_utc{};
  std::string returned_utc{};  // empty while it is active
  std::string acknowledged_by{};
  std::string acknowledged_utc{};
  std::string confirmed_by{};
  std::string confirmed_utc{};
  AlarmShelf shelf{};
  bool of_earlier_run{};  // takes no more raises: who has begun a run wants to see what trips in it
};

struct AlarmRaise {
  std::string code{};
  std::string text{};
  int cycle{};
  std::string phase{};
  AlarmPriority priority{AlarmPriority::kMedium};
  bool latching{};
  double time_s{};
  std::string utc{};
};

/// When a raise is counted on an instance that is there, in place of making a new one.
struct ChatterLimits {
  double again_within_s{60.0};  // since the last of its kind returned
  int most_of_a_kind{3};        // new ones within the period
  double period_s{600.0};
  /// New ones of all kinds within the period; beyond it a kind with an open instance makes no further one. A
  /// kind without one still does, so that no flood hides what it began with or what it brings.
  int most_of_all{10};
};

/// What is within this time of the first counts as one upset.
inline constexpr double kFirstOutWindow_s = 1.0;
inline constexpr double kLongestShelf_s = 24.0 * 3600.0;

enum class RaiseEffect { kNew, kStillActive, kShelved, kChatter, kFlood };

struct RaiseResult {
  std::size_t index{};  // of the instance that the raise is of
  RaiseEffect effect{RaiseEffect::kNew};
};

/// @param instances  all that are open, and those raised within the period; oldest first.
RaiseResult Raise(std::vector<AlarmInstance>& instances, const AlarmRaise& raise,
                  const ChatterLimits& limits = {});

/// @return whether it was active.
bool Return(AlarmInstance& instance, double time_s, std::string_view utc);

/// What a person does. @param shelf  of a kShelve. @return whether that is allowed in its state; where it is
/// not, nothing has changed.
bool Act(AlarmInstance& instance, AlarmEvent event, std::string_view by, std::string_view utc,
         const AlarmShelf& shelf = {});

/// @param elapsed_s  since it was shelved; nothing where no clock knows that, which ends a shelf.
bool IsShelfOver(const AlarmInstance& instance, std::optional<double> elapsed_s);

}  // namespace strainwave::bench
