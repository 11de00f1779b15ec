// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/time_to_go.h"

#include <algorithm>
#include <variant>
#include <vector>

#include "bench/campaign/cycle_steps.h"

namespace strainwave::bench {
namespace {

// Of the planned time of the step that a row is of.
double Done_s(const CycleStep& step, const PhaseRow& row, double credited_load_s, double bench_time_s) {
  if (row.outcome == "complete") return step.planned_s;
  if (const auto* load = std::get_if<schedules::LoadRun>(&step.phase->parameters)) {
    return step.planned_s * std::clamp(credited_load_s / load->duration_s, 0.0, 1.0);
  }
  if (row.outcome != "running") return 0.0;  // it begins anew
  return std::clamp(bench_time_s - row.started_s, 0.0, step.planned_s);
}

}  // namespace

double TimeToGo_s(const schedules::Schedule& schedule, int cycle, std::span<const PhaseRow> rows,
                  double credited_load_s, double bench_time_s) {
  const std::vector<CycleStep> steps = StepsOf(schedule, cycle);
  const double cycles_s = PlannedDuration_s(StepsOf(schedule, 1)) * std::max(0, schedule.cycles - cycle);
  if (cycle > schedule.cycles) return 0.0;
  double done_s = 0.0;
  if (!rows.empty()) {
    const auto step = std::ranges::find(steps, rows.back().step, &CycleStep::index);
    if (step != steps.end())
      done_s = step->begins_s + Done_s(*step, rows.back(), credited_load_s, bench_time_s);
  }
  return PlannedDuration_s(steps) - done_s + cycles_s;
}

std::optional<double> PhaseShare(const schedules::Schedule& schedule, int cycle,
                                 std::span<const PhaseRow> rows, double credited_load_s,
                                 double bench_time_s) {
  if (rows.empty()) return std::nullopt;
  const std::vector<CycleStep> steps = StepsOf(schedule, cycle);
  const auto step = std::ranges::find(steps, rows.back().step, &CycleStep::index);
  if (step == steps.end() || step->planned_s <= 0.0) return std::nullopt;
  return Done_s(*step, rows.back(), credited_load_s, bench_time_s) / step->planned_s;
}

}  // namespace strainwave::bench
