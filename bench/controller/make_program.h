// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "bench/controller/phase_program.h"
#include "bench/safety/state_machine.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// The program that runs a phase of a schedule.
/// @param credited_load_s  load time that earlier attempts have served (load runs only).
/// @param period_s         in which it is stepped: the bench's control period, or less for a sweep.
std::unique_ptr<PhaseProgram> MakeProgram(const schedules::PhaseParameters& phase,
                                          const schedules::Specimen& specimen, double credited_load_s,
                                          double period_s);

/// The event that begins a phase of this kind.
BenchEvent BeginEvent(const schedules::PhaseParameters& phase);

}  // namespace strainwave::bench
