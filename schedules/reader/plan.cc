// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/units.h"

namespace strainwave::schedules {
namespace {

// What the bench writes a row: time and angles in float64, what is good to four digits in float32.
constexpr std::uint64_t kLoadRunRow_bytes = 8 + 8 * 4;       // time; speed, torques, vibration, temperatures
constexpr std::uint64_t kRotationRow_bytes = 3 * 8 + 4 * 4;  // time, both angles; speed, torques, temperature
constexpr std::uint64_t kTransmissionErrorRow_bytes =
    5 * 8 + 1;                                         // time, both angles, torque, temperature; direction
constexpr std::uint64_t kHysteresisRow_bytes = 5 * 8;  // time, torque, both angles, temperature
constexpr std::uint64_t kCheckRow_bytes = 3 * 8;       // time, two channels
constexpr std::uint64_t kVibrationRow_bytes = 4 * 4;   // three axes on the gear, one on the motor

// How the bench makes the moves that no schedule describes.
constexpr double kRotationTorqueRate_Nm_per_s = 200.0;
constexpr double kSweepApproach_rad =
    RadFromDeg(5.0);  // of the output, so that every step comes from one side
constexpr double kBlankLogRate_hz = 50.0;
constexpr double kBlankStep_s = 0.35;
constexpr double kCheckSettle_s = 1.0;
constexpr double kZeroDither_s = 18.0;  // before a zero is read

std::uint64_t Whole(double value) {
  constexpr double kMost = 1e18;
  return static_cast<std::uint64_t>(std::clamp(std::round(value), 0.0, kMost));
}

// One phase planned: its time, its loads, its raw data.
struct PhasePlan {
  PhaseTime time;
  std::vector<LoadBlock> load_blocks;
  std::vector<StreamPlan> streams;
};

class Planner {
 public:
  Planner(const Specimen& specimen, const PlanAssumptions& assumptions, PhasePlan& plan)
      : ratio_(std::abs(specimen.ratio)), assumptions_(assumptions), plan_(plan) {}

  void operator()(const LoadRun& run) const {
    const double leg_rad = run.turns * kTwoPi * ratio_;
    const double leg_s = MoveTime_s(leg_rad, run.input_speed_rad_per_s, run.input_acceleration_rad_per_s2);
    plan_.time.load_s = run.duration_s;
    // The ramp up belongs to the load run, the ramp down follows it.
    plan_.time.other_s = std::max(run.output_torque_Nm / run.torque_rate_Nm_per_s,
                                  run.input_speed_rad_per_s / run.input_acceleration_rad_per_s2);
    plan_.load_blocks.push_back({run.output_torque_Nm, leg_rad / leg_s, run.duration_s});
    AddStream("", run.duration_s * run.log_rate_hz, kLoadRunRow_bytes);
  }

  void operator()(const MeasurementRotation& rotation) const {
    const double turn_rad = rotation.turns * kTwoPi * ratio_;
    // The turn is made at full speed; run-up and run-out come on top.
    const double at_speed_s = turn_rad / rotation.input_speed_rad_per_s;
    const double ramp_s = std::max(rotation.input_speed_rad_per_s / rotation.input_acceleration_rad_per_s2,
                                   rotation.output_torque_Nm / kRotationTorqueRate_Nm_per_s);
    plan_.time.measuring_s = at_speed_s + 2.0 * ramp_s;
    plan_.load_blocks.push_back({rotation.output_torque_Nm, rotation.input_speed_rad_per_s, at_speed_s});
    AddStream("", at_speed_s * rotation.log_rate_hz, kRotationRow_bytes);
    AddStream("/vibration", at_speed_s * rotation.vibration_rate_hz, kVibrationRow_bytes);
  }

  void operator()(const TransmissionErrorSweep& sweep) const {
    const auto move_s = [&](double output_rad) {
      const double exact_s =
          MoveTime_s(output_rad * ratio_, sweep.input_speed_rad_per_s, sweep.input_acceleration_rad_per_s2);
      return std::ceil(exact_s / assumptions_.control_period_s) * assumptions_.control_period_s;
    };
    const double directions = (sweep.clockwise ? 1.0 : 0.0) + (sweep.counter_clockwise ? 1.0 : 0.0);
    const double readings = sweep.steps + 1.0;  // the first one before the first step
    plan_.time.measuring_s =
        directions * (sweep.steps * move_s(sweep.step_rad) + 2.0 * move_s(kSweepApproach_rad) +
                      readings * (sweep.settle_s + sweep.averaging_s));
    AddStream("", directions * readings, kTransmissionErrorRow_bytes);
  }

  void operator()(const HysteresisTest& test) const {
    // 0 → +T → −T … → 0: a quarter up, then halves, a quarter back; a hold at each end.
    const double loop_s = (4.0 * test.loops + 2.0) * test.peak_torque_Nm / test.torque_rate_Nm_per_s +
                          (2.0 * test.loops + 2.0) * test.hold_s;
    const auto angles = static_cast<double>(test.lock_angles_rad.size());
    plan_.time.measuring_s = angles * loop_s;
    plan_.time.other_s = angles * (assumptions_.lock_move_s + 2.0 * assumptions_.brake_s);
    AddStream("", angles * loop_s * test.log_rate_hz, kHysteresisRow_bytes);
  }

  void operator()(const Soak& soak) const {
    plan_.time.other_s = soak.at_most_s;
    plan_.time.at_most = true;
  }

  void operator()(const BlankTest& test) const {
    const double ramp_s = 6.0 * test.peak_torque_Nm / test.torque_rate_Nm_per_s;  // one loop of a lock test
    plan_.time.other_s = ramp_s + test.steps * kBlankStep_s;
    AddStream("/ramp", ramp_s * kBlankLogRate_hz, kHysteresisRow_bytes);
    AddStream("/turn", test.steps + 1.0, kTransmissionErrorRow_bytes);
  }

  void operator()(const SensorCheck& check) const {
    // A shunt is read without and with it.
    const double segments = check.kind == SensorCheck::Kind::kShunt ? 2.0 : 1.0;
    const double dither_s = check.kind == SensorCheck::Kind::kZero ? kZeroDither_s : 0.0;
    plan_.time.other_s = segments * (check.duration_s + kCheckSettle_s) + dither_s;
    AddStream("", segments * check.duration_s / assumptions_.control_period_s, kCheckRow_bytes);
  }

 private:
  void AddStream(std::string_view suffix, double rows, std::uint64_t bytes_per_row) const {
    plan_.streams.push_back({plan_.time.name + std::string(suffix), Whole(rows), bytes_per_row, 0});
  }

  double ratio_;
  const PlanAssumptions& assumptions_;
  PhasePlan& plan_;
};

std::vector<PhasePlan> PlanPhases(const std::vector<Phase>& phases, const Specimen& specimen,
                                  const PlanAssumptions& assumptions) {
  std::vector<PhasePlan> plans;
  for (const Phase& phase : phases) {
    PhasePlan& plan = plans.emplace_back();
    plan.time.name = phase.name;
    plan.time.kind = KindName(phase.parameters);
    std::visit(Planner(specimen, assumptions, plan), phase.parameters);
  }
  return plans;
}

void Add(PhaseTime& sum, const PhaseTime& time, double times) {
  sum.load_s += times * time.load_s;
  sum.measuring_s += times * time.measuring_s;
  sum.other_s += times * time.other_s;
  sum.at_most = sum.at_most || time.at_most;
}

void AddStreams(Plan& plan, const PhasePlan& phase, double times) {
  for (StreamPlan stream : phase.streams) {
    stream.bytes_total =
        Whole(static_cast<double>(stream.rows_per_cycle) * static_cast<double>(stream.bytes_per_row) * times);
    plan.disk_bytes = Whole(static_cast<double>(plan.disk_bytes) + static_cast<double>(stream.bytes_total));
    plan.streams.push_back(std::move(stream));
  }
}

std::chrono::system_clock::time_point EndOf(std::chrono::system_clock::time_point start, double duration_s) {
  using std::chrono::system_clock;
  constexpr system_clock::time_point kLatest = std::chrono::sys_days{std::chrono::year{2200} / 1 / 1};
  const double room_s = std::chrono::duration<double>(kLatest - start).count();
  if (duration_s >= room_s) return kLatest;
  return start +
         std::chrono::duration_cast<system_clock::duration>(std::chrono::duration<double>(duration_s));
}

}  // namespace

double MoveTime_s(double distance, double speed, double acceleration) {
  if (speed * speed >= distance * acceleration) return 2.0 * std::sqrt(distance / acceleration);
  return distance / speed + speed / acceleration;
}

Plan MakePlan(const Schedule& schedule, std::chrono::system_clock::time_point start,
              const PlanAssumptions& assumptions) {
  Plan plan;
  plan.cycles = schedule.cycles;
  plan.start = start;
  plan.cycle.name = "cycle";
  plan.repeats.name = "repeats";
  PhaseTime campaign;
  const double repeats = schedule.measurements.repeatability_repeats;

  for (const PhasePlan& phase : PlanPhases(schedule.preparation, schedule.specimen, assumptions)) {
    plan.preparation.push_back(phase.time);
    Add(campaign, phase.time, 1.0);
    plan.once_load_blocks.insert(plan.once_load_blocks.end(), phase.load_blocks.begin(),
                                 phase.load_blocks.end());
    AddStreams(plan, phase, 1.0);
  }
  for (const PhasePlan& phase : PlanPhases(schedule.phases, schedule.specimen, assumptions)) {
    const bool repeated = phase.time.measuring_s > 0.0;
    plan.phases.push_back(phase.time);
    Add(plan.cycle, phase.time, 1.0);
    if (repeated) Add(plan.repeats, phase.time, repeats);
    for (LoadBlock block : phase.load_blocks) {
      plan.cycle_load_blocks.push_back(block);
      block.duration_s *= repeats;
      if (repeated && repeats > 0.0) plan.once_load_blocks.push_back(block);
    }
    AddStreams(plan, phase, schedule.cycles + (repeated ? repeats : 0.0));
  }
  plan.cycle.other_s += assumptions.store_s;
  Add(campaign, plan.cycle, schedule.cycles);
  Add(campaign, plan.repeats, 1.0);

  plan.load_s = campaign.load_s;
  plan.measuring_s = campaign.measuring_s;
  plan.other_s = campaign.other_s;
  plan.wall_s = campaign.total_s();
  plan.at_most = campaign.at_most;
  plan.expected_end = EndOf(start, plan.wall_s);
  return plan;
}

}  // namespace strainwave::schedules
