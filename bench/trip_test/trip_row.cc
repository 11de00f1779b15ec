// SPDX-License-Identifier: Apache-2.0
#include "bench/trip_test/trip_row.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <variant>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/alarms/alarm_rules.h"
#include "bench/configuration/sensors_of.h"
#include "bench/errors/bench_error.h"
#include "bench/safety/drive_watch.h"
#include "bench/safety/interlocks.h"
#include "schedules/reader/wording.h"

namespace strainwave::bench {
namespace {

constexpr std::array kServos{BenchServo::kDriving, BenchServo::kLoad};
// Without one of these nothing may turn (Interlocks::CheckAll) ...
constexpr std::array kGuards{Channel::kOutputTorque, Channel::kInputAngle, Channel::kOutputAngle,
                             Channel::kInputSpeed};
// ... without one of these a run is suspended.
constexpr std::array kSlowChannels{Channel::kMotorTorque, Channel::kGearTemperature,
                                   Channel::kAmbientTemperature, Channel::kVibrationRms};
// An encoder that repeats its last value is told within this (docs/requirements.md R22).
constexpr double kFrozenFoundWithin_s = 2.0;
// A set point that a servo is away from: the measured value is low-passed, and the time to settle is left
// out.
constexpr double kAwaySlack_s = 1.0;
// What the drive says of its brake counts when it says it again.
constexpr double kAnswersOfABrake = 2.0;

double WaitsFor_s(StopCause cause, const TripSettings& settings, double at_once_s) {
  switch (cause) {
    case StopCause::kBrakeEngaged:
      return (kAnswersOfABrake - 1.0) * at_once_s;
    case StopCause::kInputAngleApart:
      return kFrozenFoundWithin_s;
    case StopCause::kDriveNotReady:
      return std::chrono::duration<double>(DriveWatch::kLongestWayUp).count();
    case StopCause::kTorqueAway:
    case StopCause::kSpeedAway:
      return settings.tolerances.dwell_s + kAwaySlack_s;
    case StopCause::kSensorSuspend:
      return settings.suspend.bad_sensor_s;
    default:
      return 0.0;
  }
}

TripLimit LimitOf(StopCause cause, const InterlockRow& row, const TripSettings& settings,
                  const BenchDescription& bench) {
  const schedules::Limits& limits = settings.limits;
  const std::string key(row.limit);
  switch (cause) {
    case StopCause::kOutputTorqueLimit:
      return {limits.output_torque_Nm, "Nm", key};
    case StopCause::kInputSpeedLimit:
      return {RpmFromRadPerS(limits.input_speed_rad_per_s), "rpm", key};
    case StopCause::kGearTemperatureLimit:
      return {limits.gear_temperature_degC, "degC", key};
    case StopCause::kVibrationLimit:
      return {limits.vibration_rms_m_per_s2, "m/s2", key};
    case StopCause::kTwistLimit:
      return {ArcminFromRad(limits.twist_rad), "arcmin", key};
    case StopCause::kStaleReadings:
    case StopCause::kDriveSilent:
      return {1e3 * bench.stale_after_s, "ms", "stale_after"};
    case StopCause::kDriveNotReady:
      return {std::chrono::duration<double>(DriveWatch::kLongestWayUp).count(), "s", "until " + key};
    case StopCause::kTorqueAway:
      return {100.0 * settings.tolerances.torque_share, "%", "torque_tolerance"};
    case StopCause::kSpeedAway:
      return {100.0 * settings.tolerances.speed_share, "%", "speed_tolerance"};
    case StopCause::kTemperatureSuspend:
      return {settings.suspend.trip_temperature_degC, "degC", key};
    case StopCause::kSensorSuspend:
      return {settings.suspend.bad_sensor_s, "s", key};
    default:
      return {std::nullopt, "", key};
  }
}

bool IsOfEitherServo(StopCause cause) {
  return cause == StopCause::kDriveFault || cause == StopCause::kDriveNotReady ||
         cause == StopCause::kDriveDroppedOut || cause == StopCause::kBrakeEngaged ||
         cause == StopCause::kDriveSilent;
}

// What of the row's condition people call the part that one cause is about.
std::string SignalOf(const InterlockRow& row, StopCause cause) {
  switch (cause) {
    case StopCause::kDriveNotReady:
      return "drive comes up";
    case StopCause::kDriveDroppedOut:
      return "drive stays enabled";
    case StopCause::kBrakeEngaged:
      return "brake stays off";
    case StopCause::kTorqueAway:
      return "torque asked for";
    case StopCause::kSpeedAway:
      return "speed asked for";
    case StopCause::kImplausibleReading:
      return "value";
    default:
      return std::string(row.signal);
  }
}

void AppendRows(const InterlockRow& row, StopCause cause, const TripSettings& settings,
                const BenchDescription& bench, std::vector<TripRow>& rows) {
  const double at_once_s = bench.stale_after_s + bench.control_period_s;
  TripRow one;
  one.cause = cause;
  one.signal = SignalOf(row, cause);
  one.limit = LimitOf(cause, row, settings, bench);
  one.action = row.action;
  one.latches = IsLatching(Code(cause), bench.alarms);
  one.noticed_within_s = at_once_s + WaitsFor_s(cause, settings, at_once_s);
  one.safe_within_s = one.noticed_within_s + bench.longest_stop_s;
  one.unwatched = row.unwatched;
  const auto append = [&](std::string_view of) {
    rows.push_back(one);
    if (!of.empty()) rows.back().signal += fmt::format(", {}", of);
  };
  if (IsOfEitherServo(cause)) {
    for (const BenchServo servo : kServos) {
      one.servo = servo;
      append(NameOf(servo));
    }
  } else if (cause == StopCause::kImplausibleReading || cause == StopCause::kSensorSuspend) {
    const auto channels = cause == StopCause::kImplausibleReading ? kGuards : kSlowChannels;
    for (const Channel channel : channels) {
      one.channel = channel;
      const bool is_there = channel != Channel::kVibrationRms || SensorsOf(bench).vibration;
      one.unwatched = is_there ? "" : "the bench has no accelerometers";
      append(NameOf(channel));
    }
  } else {
    append("");
  }
}

}  // namespace

TripSettings TripSettingsOf(const schedules::Schedule& schedule) {
  TripSettings settings{schedule.limits, schedule.suspend, schedule.specimen, {}};
  for (const schedules::Phase& phase : schedule.phases) {
    const auto* const run = std::get_if<schedules::LoadRun>(&phase.parameters);
    if (run == nullptr) continue;
    settings.tolerances = run->tolerances;
    break;
  }
  return settings;
}

TripSettings TripSettingsOf(const BenchDescription& bench) {
  TripSettings settings;
  settings.limits = {.output_torque_Nm = bench.transducer.range_Nm,
                     .input_speed_rad_per_s = bench.driving_servo.peak_speed_rad_per_s,
                     .gear_temperature_degC = 75.0,
                     .vibration_rms_m_per_s2 = 50.0,
                     .twist_rad = RadFromArcmin(30.0)};
  settings.suspend = {.trip_temperature_degC = 70.0,
                      .resume_temperature_degC = 60.0,
                      .dwell_s = 60.0,
                      .bad_sensor_s = 2.0,
                      .give_up_s = 4.0 * 3600.0};
  settings.specimen.ratio = 80.0;
  settings.specimen.t1_Nm = 7.0;
  settings.specimen.t2_Nm = 25.0;
  settings.specimen.t3_Nm = 34.0;
  settings.specimen.rated_torque_Nm = 34.0;
  return settings;
}

std::vector<TripRow> TripRows(const TripSettings& settings, const BenchDescription& bench) {
  std::vector<TripRow> rows;
  for (const InterlockRow& row : Interlocks::Table(SensorsOf(bench))) {
    for (const StopCause cause : row.causes) AppendRows(row, cause, settings, bench, rows);
  }
  return rows;
}

bool IsAbout(const TripRow& row, const StopReason& reason) {
  if (reason.cause != row.cause) return false;
  if (row.servo && reason.servo != *row.servo) return false;
  return !row.channel || ChannelOf(reason) == row.channel;
}

std::vector<TripRow> OnlyRows(const std::vector<TripRow>& rows, const std::vector<std::string>& codes) {
  if (codes.empty()) return rows;
  std::vector<std::string_view> known;
  for (const TripRow& row : rows) {
    if (std::ranges::count(known, Code(row.cause)) == 0) known.push_back(Code(row.cause));
  }
  for (const std::string& code : codes) {
    if (std::ranges::count(known, code) != 0) continue;
    const std::optional<std::string> near = schedules::NearestWord(code, known);
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("--only {}: error: no interlock has this code{} (expected {})", code,
                    near ? fmt::format(", did you mean '{}'?", *near) : "", schedules::Alternatives(known)));
  }
  std::vector<TripRow> chosen;
  std::ranges::copy_if(rows, std::back_inserter(chosen),
                       [&](const TripRow& row) { return std::ranges::count(codes, Code(row.cause)) != 0; });
  return chosen;
}

}  // namespace strainwave::bench
