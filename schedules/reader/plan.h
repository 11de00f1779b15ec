// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "schedules/reader/schedule.h"

namespace strainwave::schedules {

/// What a plan must assume of the bench, because no schedule says it.
struct PlanAssumptions {
  double control_period_s{0.01};  // moves end on one
  double brake_s{0.2};            // to engage or release a brake
  double lock_move_s{1.0};        // of the input to the next lock angle
  double store_s{0.0};            // at the end of a cycle, not overlapped with the next
};

/// Planned time of one phase, by what it counts as. Load time is what the schedule asks for, its ramp up
/// included; the ramp down is other time.
struct PhaseTime {
  std::string name;
  std::string kind;
  double load_s{};
  double measuring_s{};
  double other_s{};
  bool at_most{};  // a soak ends earlier when the gear is cool

  double total_s() const { return load_s + measuring_s + other_s; }
};

/// A segment at one load, for the life of the bearing. The speed is the mean over the reversals, since life
/// goes by revolutions.
struct LoadBlock {
  double output_torque_Nm{};
  double mean_input_speed_rad_per_s{};
  double duration_s{};
};

/// Raw data of one phase on one time base.
struct StreamPlan {
  std::string name;  // "PHASE", or "PHASE/vibration" and the like
  std::uint64_t rows_per_cycle{};
  std::uint64_t bytes_per_row{};
  std::uint64_t bytes_total{};  // of the campaign, repeats before the first cycle included
};

struct Plan {
  std::vector<PhaseTime> preparation;  // once
  std::vector<PhaseTime> phases;       // each cycle
  PhaseTime cycle;                     // sum of `phases`
  PhaseTime repeats;                   // the measurements repeated before the first cycle, all together
  int cycles{};

  // The whole campaign.
  double load_s{};
  double measuring_s{};
  double other_s{};
  double wall_s{};
  bool at_most{};
  std::chrono::system_clock::time_point start;
  std::chrono::system_clock::time_point expected_end;  // not later than the year 2200

  std::vector<LoadBlock> once_load_blocks;   // preparation and repeats
  std::vector<LoadBlock> cycle_load_blocks;  // of one cycle

  std::vector<StreamPlan> streams;
  std::uint64_t disk_bytes{};
};

/// Time for a move from standstill to standstill over `distance` with speed and acceleration limited:
/// d/v + v/a, or 2·√(d/a) when the speed is not reached.
double MoveTime_s(double distance, double speed, double acceleration);

/// Works out durations, load and disk of a campaign from its schedule. Retries, suspensions and pauses are
/// not in it, and no stop criterion is met.
///
/// Raw data are counted uncompressed and without the files' own overhead.
Plan MakePlan(const Schedule& schedule, std::chrono::system_clock::time_point start,
              const PlanAssumptions& assumptions = {});

}  // namespace strainwave::schedules
