// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/configuration/bench_description.h"
#include "bench/roles/sampler.h"
#include "bench/safety/stop_reason.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// What the interlocks are tested with: those parts of a schedule that they look at.
struct TripSettings {
  schedules::Limits limits;
  schedules::SuspendRule suspend;
  schedules::Specimen specimen;
  schedules::SetPointTolerances tolerances;
};

/// Of a schedule; the tolerances are those of its first load run.
TripSettings TripSettingsOf(const schedules::Schedule& schedule);

/// For a simulated bench and no schedule: what its sensors measure to, and the thresholds of
/// schedules/quick.yaml.
TripSettings TripSettingsOf(const BenchDescription& bench);

/// Where an interlock trips: a value with its unit, where it has one, and what people look it up by.
struct TripLimit {
  std::optional<double> value;  // in `unit`
  std::string unit;             // "Nm", "rpm", "degC", "m/s2", "arcmin", "ms", "s", "%"
  std::string key;              // "limits.output_torque"; a condition in words where no file has it
};

/// One interlock of `Interlocks::Table` under test: one cause, and of a drive or a channel which.
struct TripRow {
  StopCause cause{};
  std::optional<BenchServo> servo;
  std::optional<Channel> channel;  // that gives no value
  std::string signal;              // "drive fault, driving servo"
  TripLimit limit;
  std::string action;         // "torque off, brakes on"
  bool latches{};             // its alarm (bench/alarms/alarm_rules.h)
  double noticed_within_s{};  // after the condition began, at most
  double safe_within_s{};     // the same, until torque is off, the brakes are on and the shafts stand
  std::string unwatched;      // why this bench does not watch it; empty: it does
};

/// Every row of the table, in its order.
///
/// Noticed within: readings and drives' states may be as old as `stale_after` allows, and are looked at once
/// a control period; to that comes what the interlock itself waits for. Safe within: the same, and the
/// bench's `longest_stop_time`.
std::vector<TripRow> TripRows(const TripSettings& settings, const BenchDescription& bench);

/// Whether a stop has the row's cause, by the drive or channel that it is about.
bool IsAbout(const TripRow& row, const StopReason& reason);

/// The rows of these codes ("drive_fault" has two), in the order of the table; all for no code.
/// @throws BenchError for a code that no row has, with the nearest of those that there are.
std::vector<TripRow> OnlyRows(const std::vector<TripRow>& rows, const std::vector<std::string>& codes);

}  // namespace strainwave::bench
