// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include "bench/report/number_text.h"
#include "bench/report/sections.h"

namespace strainwave::bench {
namespace {

std::string PercentOfL10(double share) { return fmt::format("{:.4g}", 100.0 * share); }

ReportTable RunsTable(const std::vector<LoadRunShare>& runs) {
  ReportTable table{"load_life",
                    {"load run", "runs", "as planned (% of L10)", "measured in", "as measured (% of L10)"},
                    {}};
  for (const LoadRunShare& run : runs)
    table.rows.push_back({run.phase, std::to_string(run.runs), PercentOfL10(run.planned),
                          std::to_string(run.runs_measured),
                          run.runs_measured == 0 ? "–" : PercentOfL10(run.measured)});
  return table;
}

// Without the trail of noughts that a whole count would have.
std::string CyclesText(double cycles) { return fmt::format("{:.1f}", cycles); }

ReportTable RangesTable(const LoadHistory& load) {
  ReportTable table{"load_ranges",
                    {"range from (Nm)", "to (Nm)", "cycles", "middle (Nm)", "reversals of ± rated torque",
                     "planned cycles", "planned reversals"},
                    {}};
  const std::size_t count = std::max(load.ran.classes.size(), load.planned.classes.size());
  for (std::size_t i = count; i-- > 0;) {
    const auto at = [i](const LoadSpectrum& spectrum) {
      return i < spectrum.classes.size() ? spectrum.classes[i] : LoadSpectrum::Class{};
    };
    const LoadSpectrum::Class ran = at(load.ran);
    const LoadSpectrum::Class planned = at(load.planned);
    if (ran.cycles == 0.0 && planned.cycles == 0.0) continue;
    const double width_Nm = load.ran.width_Nm;
    table.rows.push_back({fmt::format("{:g}", static_cast<double>(i) * width_Nm),
                          fmt::format("{:g}", static_cast<double>(i + 1) * width_Nm), CyclesText(ran.cycles),
                          ran.cycles > 0.0 ? Fixed(ran.mean_sum_Nm / ran.cycles, 2) : "–",
                          fmt::format("{:.4g}", ran.reversals), CyclesText(planned.cycles),
                          fmt::format("{:.4g}", planned.reversals)});
  }
  return table;
}

}  // namespace

ReportSection LoadSection(const CampaignSheet& sheet) {
  ReportSection section{"Load that really ran", {}};
  const LoadHistory& load = sheet.load;
  if (!sheet.load_runs.empty()) {
    section.parts.emplace_back(
        "Bearing of the wave generator: share of its L10 used up by the load runs (life goes with the cube "
        "of "
        "the torque and the revolutions; shares add up, after Miner). As measured: the torque and speed of "
        "each control period of the load that was credited, which the journal keeps of every cycle; load "
        "outside of the phase's tolerances, and the measurements, are left out.");
    section.parts.emplace_back(RunsTable(sheet.load_runs));
  }
  if (load.cycles_read == 0) {
    section.parts.emplace_back("No cycle's file could be read: the torque's ranges are not counted.");
    return section;
  }
  section.parts.emplace_back(fmt::format(
      "Ranges of the output torque, counted as rainflow (ASTM E1049-85) over {} cycle file(s) one after "
      "another, "
      "the "
      "preparation's among them where it has torque. Of a load run each row of the log counts with its "
      "smallest and its largest torque, which hold every reading of the control loop; what goes and comes "
      "back within a row counts once. Of the measurements all samples count. Between phases the gear is "
      "without torque. Left out: the blank test, in which there is no gear, moves between phases, and of "
      "a phase that was cut by a kill or a power cut the rows not yet written.",
      load.cycles_read));
  if (!load.cycles_missing.empty())
    section.parts.emplace_back(
        fmt::format("Not counted: {} of {} cycles, whose file is not whole or has no torque (the first: {}).",
                    load.cycles_missing.size(), sheet.complete, load.cycles_missing.front()));
  section.parts.emplace_back(fmt::format(
      "Largest range {:.4g} Nm. Of the teeth and the flexspline the schedule has no S-N curve. With the "
      "bearing's cube the ranges that ran do as much as {:.5g} reversals between + and − rated torque ({:g} "
      "Nm); "
      "as planned, for the same cycles and counted alike, {:.5g}.",
      load.ran.largest_Nm, load.ran.reversals(), sheet.inputs.schedule.specimen.rated_torque_Nm,
      load.planned.reversals()));
  section.parts.emplace_back(RangesTable(load));
  return section;
}

}  // namespace strainwave::bench
