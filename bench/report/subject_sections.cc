// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/campaign/calibrations.h"
#include "bench/campaign/life_share.h"
#include "bench/report/number_text.h"
#include "bench/report/schedule_words.h"
#include "bench/report/sections.h"
#include "schedules/reader/plan.h"

namespace strainwave::bench {
namespace {

std::string OrNone(const std::string& text) { return text.empty() ? "none" : text; }

std::string PropertyOf(const CampaignSheet& sheet, const char* key) { return sheet.properties.at(key); }

double UsedLifeShare(const CampaignSheet& sheet) {
  const schedules::Schedule& schedule = sheet.inputs.schedule;
  const schedules::Plan plan = schedules::MakePlan(schedule, {});  // of which no date is looked at
  return LifeShare(schedule.specimen, plan.once_load_blocks) +
         LifeShare(schedule.specimen, plan.cycle_load_blocks) * sheet.complete;
}

// Of load runs alone, which the plan's share has beside the measurements.
std::string MeasuredWords(const CampaignSheet& sheet) {
  double measured = 0.0;
  int runs_measured = 0;
  for (const LoadRunShare& run : sheet.load_runs) {
    measured += run.measured;
    runs_measured += run.runs_measured;
  }
  return runs_measured == 0 ? "not measured"
                            : fmt::format("{:.3g} % by the load runs as measured", 100.0 * measured);
}

// Of all runs, each once, in the order in which they came.
std::string SoftwareOf(const CampaignSheet& sheet) {
  std::vector<std::string> versions;
  for (const Event& event : sheet.events) {
    if (event.code == "software" && (versions.empty() || versions.back() != event.text))
      versions.push_back(event.text);
  }
  return versions.empty() ? "not noted" : fmt::format("{}", fmt::join(versions, ", then "));
}

}  // namespace

ReportSection SubjectSection(const CampaignSheet& sheet) {
  const schedules::Specimen& specimen = sheet.inputs.schedule.specimen;
  const BenchDescription& bench = sheet.inputs.bench;
  const std::string last = sheet.events.empty() ? "not noted" : sheet.events.back().utc;
  ReportTable table{
      "subject",
      {"what", "is"},
      {{"specimen", specimen.identity},
       {"model", OrNone(specimen.model)},
       {"ratio", fmt::format("{:g}", specimen.ratio)},
       {"T1, T2, T3", fmt::format("{:g}, {:g}, {:g} Nm", specimen.t1_Nm, specimen.t2_Nm, specimen.t3_Nm)},
       {"rated", fmt::format("{:g} Nm at {:.5g} rpm of the input", specimen.rated_torque_Nm,
                             RpmFromRadPerS(specimen.rated_speed_rad_per_s))},
       {"L10 of the wave-generator bearing",
        fmt::format("{:g} h at rated load", specimen.bearing_l10_s / 3600.0)},
       {"bench", OrNone(bench.name)},
       {"schedule", sheet.inputs.schedule.name},
       {"begun", OrNone(PropertyOf(sheet, "started_utc"))},
       {"last event", last},
       {"cycles complete", fmt::format("{} of {}", sheet.complete, sheet.inputs.schedule.cycles)},
       {"bench time", fmt::format("{:.4g} h, of which {:.4g} h of load credited", sheet.bench_time_s / 3600.0,
                                  sheet.load_s / 3600.0)},
       {"bearing life used up",
        fmt::format("{:.3g} % of L10, by the load of complete cycles as planned (cube law, Miner); {}",
                    100.0 * UsedLifeShare(sheet), MeasuredWords(sheet))},
       {"software", SoftwareOf(sheet)},
       {"SHA-256 of the schedule", OrNone(PropertyOf(sheet, "schedule_sha256"))},
       {"SHA-256 of the bench file", OrNone(PropertyOf(sheet, "bench_sha256"))},
       {"SHA-256 of the commissioning", OrNone(PropertyOf(sheet, "commissioned_sha256"))},
       {"SHA-256 of the plant file", OrNone(PropertyOf(sheet, "plant_sha256"))}}};
  return {"Specimen, bench and version", {std::move(table)}};
}

ReportSection CalibrationSection(const CampaignSheet& sheet) {
  ReportTable table{"calibrations", {"channel", "sensor", "certificate", "due", "unit"}, {}};
  for (const ChannelCalibration& of : CalibrationsOf(sheet.inputs.bench)) {
    table.rows.push_back({of.channel, OrNone(of.sensor_serial), OrNone(of.calibration.id),
                          of.calibration.due ? daq::acquisition::TextOf(*of.calibration.due) : "none said",
                          of.unit});
  }
  return {"Calibrations", {"As the bench file has them.", std::move(table)}};
}

ReportSection ScheduleSection(const CampaignSheet& sheet) {
  const schedules::Schedule& schedule = sheet.inputs.schedule;
  ReportTable table{"schedule", {"when", "phase", "what it does"}, {}};
  for (const schedules::Phase& phase : schedule.preparation)
    table.rows.push_back({"once, before the first cycle", phase.name, PhaseWords(phase)});
  for (const schedules::Phase& phase : schedule.phases)
    table.rows.push_back({"every cycle", phase.name, PhaseWords(phase)});
  const schedules::Limits& limits = schedule.limits;
  const schedules::MeasurementRules& rules = schedule.measurements;
  return {
      "Schedule",
      {fmt::format(
           "{} cycles. Measurements repeated before the first cycle: {}. A measurement whose check fails "
           "is taken again {} time(s). Declared temperature: {:g} ± {:g} °C.",
           schedule.cycles, rules.repeatability_repeats, rules.retries, rules.declared_temperature_degC,
           rules.temperature_tolerance_K),
       std::move(table),
       fmt::format(
           "Limits that stop the bench at once: {:g} Nm at the output, {:.5g} rpm at the input, {:g} °C, "
           "{:g} m/s² of vibration, {:.4g} arcmin of twist with the input locked.",
           limits.output_torque_Nm, RpmFromRadPerS(limits.input_speed_rad_per_s),
           limits.gear_temperature_degC, limits.vibration_rms_m_per_s2, ArcminFromRad(limits.twist_rad))}};
}

}  // namespace strainwave::bench
