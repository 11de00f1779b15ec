// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "bench/campaign/journal.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Bench time in seconds that a campaign has still to go, as planned: without retries, suspensions and
/// pauses.
/// @param cycle  the one that is under way, or next; 0: the preparation.
/// @param rows  its phases so far.
/// @param credited_load_s  of the newest phase, where that is a load run.
double TimeToGo_s(const schedules::Schedule& schedule, int cycle, std::span<const PhaseRow> rows,
                  double credited_load_s, double bench_time_s);

/// Done of the phase of the newest row, 0 to 1, as above; nothing where the schedule has no such phase.
std::optional<double> PhaseShare(const schedules::Schedule& schedule, int cycle,
                                 std::span<const PhaseRow> rows, double credited_load_s, double bench_time_s);

}  // namespace strainwave::bench
