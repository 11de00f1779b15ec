// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <span>
#include <string_view>
#include <vector>

#include "bench/roles/bench_sensors.h"
#include "bench/roles/sampler.h"
#include "bench/roles/servo_drive.h"
#include "bench/safety/stop_reason.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// What one evaluation looks at, besides the readings.
struct InterlockInputs {
  DriveActual driving;
  DriveActual load;
  bool input_locked{};  // the twist limit holds only then
  double twist_rad{};   // output travel since the input was locked
  std::chrono::nanoseconds now{};
};

/// One row of the interlock table, for `validate` and `bench trip-test`.
struct InterlockRow {
  std::string_view signal;
  std::string_view limit;
  std::string_view action;
  std::vector<StopCause> causes;  // that a stop by it may have
  std::string_view unwatched{};   // why this bench does not watch it; empty: it does
};

/// All limits of the bench in one place (docs/requirements.md R19): evaluated every control period in every
/// phase, the first one that is broken is the cause; the others are found by going on after the stop.
class Interlocks {
 public:
  Interlocks(const schedules::Limits& limits, std::chrono::nanoseconds longest_silence)
      : limits_(limits), longest_silence_(longest_silence) {}

  /// The first broken limit, or none. Allocates nothing.
  StopReason Check(const Readings& readings, const InterlockInputs& inputs) const noexcept;

  /// Every broken limit, for telling the first cause from what followed; at most `causes.size()` of them.
  std::size_t CheckAll(const Readings& readings, const InterlockInputs& inputs,
                       std::span<StopReason> causes) const noexcept;

  /// For a trip test: takes over the limits that are lower than those in force. None is ever raised.
  void Lower(const schedules::Limits& limits) noexcept;

  /// All rows; one that a bench with these sensors does not watch says why.
  static std::vector<InterlockRow> Table(const BenchSensors& sensors);

 private:
  schedules::Limits limits_;
  std::chrono::nanoseconds longest_silence_;
};

/// Temperature and sensor conditions that suspend a run and let it go on by themselves: separate thresholds
/// for trip and resume, and a dwell (docs/requirements.md R6).
class SuspendMonitor {
 public:
  explicit SuspendMonitor(const schedules::SuspendRule& rule) : rule_(rule) {}

  /// A reason to suspend, or none. Called every control period of a running phase.
  StopReason Check(const Readings& readings, double period_s) noexcept;

  /// While suspended: true when the condition has been clear for the dwell.
  bool Recovered(const Readings& readings, double period_s) noexcept;

  /// For a trip test: takes over a threshold that is lower than the one in force.
  void LowerTrip(double trip_temperature_degC) noexcept;

 private:
  schedules::SuspendRule rule_;
  double bad_for_s_{};
  double clear_for_s_{};
};

}  // namespace strainwave::bench
