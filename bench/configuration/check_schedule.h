// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/configuration/bench_description.h"
#include "schedules/reader/findings.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Checks a valid schedule against the bench that is to run it: torque within the transducer and the load
/// servo, speed and acceleration within the drives, log and vibration rates within what is sampled, limits
/// that are looked at often enough for the ramps. The places are the schedule's.
schedules::FindingList CheckScheduleAgainstBench(const schedules::Schedule& schedule,
                                                 const BenchDescription& bench);

}  // namespace strainwave::bench
