// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/read_schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "schedules/reader/read_phases.h"
#include "schedules/reader/schedule_bounds.h"
#include "schedules/reader/validate_schedule.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::schedules {
namespace {

constexpr FileKind kScheduleFile{"schedule", "schedule: 1"};
constexpr int kMostCycles = 10'000'000;
constexpr int kMostTeeth = 10'000;
constexpr double kColdest_degC = -273.0;  // keeps a default that derives from nonsense readable

Specimen ReadSpecimen(YamlMap map) {
  Specimen specimen;
  specimen.identity = map.Text("identity");
  specimen.model = map.Text("model");
  specimen.ratio = map.Number("ratio", Bound::kNotZero);
  specimen.t1_Nm = map.Quantity("t1", Dimension::kTorque, Bound::kPositive);
  specimen.t2_Nm = map.Quantity("t2", Dimension::kTorque, Bound::kPositive);
  specimen.t3_Nm = map.Quantity("t3", Dimension::kTorque, Bound::kPositive);
  specimen.rated_torque_Nm = map.Quantity("rated_torque", Dimension::kTorque, Bound::kPositive);
  specimen.rated_speed_rad_per_s = map.Quantity("rated_speed", Dimension::kAngularSpeed, Bound::kPositive);
  specimen.bearing_l10_s = map.Quantity("bearing_l10", Dimension::kTime, Bound::kPositive);
  specimen.ratcheting_torque_Nm = map.Quantity("ratcheting_torque", Dimension::kTorque, Bound::kPositive);
  specimen.buckling_torque_Nm = map.Quantity("buckling_torque", Dimension::kTorque, Bound::kPositive);
  specimen.flexspline_teeth = map.Count("flexspline_teeth", 1, kMostTeeth);
  specimen.circular_spline_teeth = map.Count("circular_spline_teeth", 1, kMostTeeth);
  map.Finish();
  return specimen;
}

Limits ReadLimits(YamlMap map) {
  Limits limits;
  limits.output_torque_Nm = map.Quantity("output_torque", Dimension::kTorque, Bound::kPositive);
  limits.input_speed_rad_per_s = map.Quantity("input_speed", Dimension::kAngularSpeed, Bound::kPositive);
  limits.gear_temperature_degC = map.Quantity("gear_temperature", Dimension::kTemperature, Bound::kPositive);
  limits.vibration_rms_m_per_s2 = map.Quantity("vibration_rms", Dimension::kAcceleration, Bound::kPositive);
  limits.twist_rad = map.Quantity("twist", Dimension::kAngle, Bound::kPositive);
  map.Finish();
  return limits;
}

// The thresholds stand below the limit of the gear's temperature unless the file places them.
SuspendRule ReadSuspendRule(YamlMap map, double temperature_limit_degC) {
  constexpr double kBelowLimit_K = 5.0;
  constexpr double kBelowTrip_K = 10.0;
  const auto derived = [](double temperature_degC) {
    return fmt::format("{} degC", std::max(temperature_degC, kColdest_degC));
  };
  SuspendRule rule;
  rule.trip_temperature_degC = map.Quantity("trip_temperature", Dimension::kTemperature, Bound::kAny,
                                            derived(temperature_limit_degC - kBelowLimit_K));
  rule.resume_temperature_degC = map.Quantity("resume_temperature", Dimension::kTemperature, Bound::kAny,
                                              derived(rule.trip_temperature_degC - kBelowTrip_K));
  rule.dwell_s = map.Quantity("dwell", Dimension::kTime, Bound::kNotNegative, "1 min");
  rule.bad_sensor_s = map.Quantity("bad_sensor", Dimension::kTime, Bound::kPositive, "2 s");
  rule.give_up_s = map.Quantity("give_up", Dimension::kTime, Bound::kPositive, "4 h");
  map.Finish();
  return rule;
}

StopCriteria ReadStopCriteria(YamlMap map) {
  StopCriteria stop;
  stop.k2_below_share_of_first =
      map.OptionalQuantity("k2_below_share_of_first", Dimension::kShare, Bound::kPositive);
  stop.e_max_above_rad = map.OptionalQuantity("e_max_above", Dimension::kAngle, Bound::kPositive);
  stop.vibration_rms_above_m_per_s2 =
      map.OptionalQuantity("vibration_rms_above", Dimension::kAcceleration, Bound::kPositive);
  map.Finish();
  return stop;
}

MeasurementRules ReadMeasurementRules(YamlMap map) {
  MeasurementRules rules;
  rules.declared_temperature_degC =
      map.Quantity("declared_temperature", Dimension::kTemperature, Bound::kAny);
  rules.temperature_tolerance_K =
      map.Quantity("temperature_tolerance", Dimension::kTemperatureDifference, Bound::kPositive, "5 K");
  rules.retries = map.Count("retries", 0, 100, "1");
  rules.on_failed_check = map.Choice<OnFailedCheck>(
      "on_failed_check", {{"store_flagged", OnFailedCheck::kStoreFlagged}, {"stop", OnFailedCheck::kStop}},
      "store_flagged");
  rules.repeatability_repeats = map.Count("repeatability_repeats", 0, 1000, "5");
  map.Finish();
  return rules;
}

ResumeRules ReadResumeRules(YamlMap map) {
  ResumeRules rules;
  rules.longest_pause_s = map.Quantity("longest_pause", Dimension::kTime, Bound::kPositive, "72 h");
  rules.re_soak_after_s = map.Quantity("re_soak_after", Dimension::kTime, Bound::kNotNegative, "30 min");
  rules.operator_acknowledges = map.Flag("operator_acknowledges", "true");
  rules.unattended = map.Count("unattended", 0, 100, "0");
  map.Finish();
  return rules;
}

Schedule ReadTop(const YamlNode& root, ReadContext& context) {
  context.bounds = ScheduleBounds();
  YamlMap map(root, context);
  map.Version("schedule");
  Schedule schedule;
  schedule.name = map.Identifier("name");
  schedule.specimen = ReadSpecimen(map.Map("specimen", Presence::kRequired));
  schedule.limits = ReadLimits(map.Map("limits", Presence::kRequired));
  schedule.suspend =
      ReadSuspendRule(map.Map("suspend", Presence::kOptional), schedule.limits.gear_temperature_degC);
  // A threshold that derives from a limit nobody could read is no more to be believed.
  for (const auto* path : {"suspend.trip_temperature", "suspend.resume_temperature"}) {
    Origin& origin = context.origins[path];
    if (origin.line == 0) origin.wrong = context.origins["limits.gear_temperature"].wrong;
  }
  schedule.cycles = map.Count("cycles", 1, kMostCycles);
  schedule.preparation = ReadPhases(map.MapList("preparation", Presence::kOptional));
  schedule.phases = ReadPhases(map.MapList("phases", Presence::kRequired));
  schedule.stop = ReadStopCriteria(map.Map("stop", Presence::kOptional));
  schedule.measurements = ReadMeasurementRules(map.Map("measurements", Presence::kRequired));
  schedule.resume = ReadResumeRules(map.Map("resume", Presence::kOptional));
  map.Finish();
  return schedule;
}

}  // namespace

Schedule ReadSchedule(const std::filesystem::path& path) {
  FindingList findings;
  const std::optional<std::string> text = ReadInputFile(path, kScheduleFile, findings);
  if (!text) throw ScheduleError(path.string(), findings);
  return ParseSchedule(*text, path.string());
}

Schedule ParseSchedule(const std::string& text, std::string_view file_name) {
  ReadContext context;
  const std::optional<YamlNode> root = ParseYaml(text, kScheduleFile, context.findings);
  if (!root) throw ScheduleError(file_name, context.findings);
  Schedule schedule = ReadTop(*root, context);
  schedule.file_name = file_name;
  schedule.origins = std::move(context.origins);
  context.findings.Append(ValidateSchedule(schedule));
  if (context.findings.has_errors()) throw ScheduleError(file_name, context.findings);
  return schedule;
}

}  // namespace strainwave::schedules
