// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "bench/configuration/bench_description.h"
#include "bench/roles/bench_machine.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// The bench that a bench file describes.
/// @param pace   of a simulated bench: times real time; infinity: as fast as it can.
/// @param truth  of a simulated bench: file that gets one row a cycle of what only the simulation knows; empty:
///   none. Rows are added; of two with one cycle number the last counts.
/// @throws CampaignError for a bench that this build has no devices for; BenchFileError for a plant term or a
///   parameter that there is not.
std::unique_ptr<BenchMachine> MakeMachine(const BenchDescription& description, const schedules::Schedule& schedule,
                                          double pace, const std::filesystem::path& truth);

}  // namespace strainwave::bench
