// SPDX-License-Identifier: Apache-2.0
#include "bench/alarms/alarm_rules.h"

#include <algorithm>
#include <array>

namespace strainwave::bench {
namespace {

constexpr std::array kKinds{
    AlarmKind{"output_torque_limit", AlarmPriority::kHigh, true,
              "Look whether the output is blocked or the load servo has run away; compare the last seconds "
              "in faults/ with the limit. Confirm when the cause is mended."},
    AlarmKind{"input_speed_limit", AlarmPriority::kHigh, true,
              "Look at the driving servo's set point and at the unit of its speed; compare the last seconds "
              "in faults/ with the limit. Confirm when the cause is mended."},
    AlarmKind{"gear_temperature_limit", AlarmPriority::kHigh, true,
              "Let the gear cool down; look at grease, cooling and room temperature, and whether the "
              "thermometer shows what the gear has. Confirm when the cause is mended."},
    AlarmKind{"vibration_limit", AlarmPriority::kHigh, true,
              "Look at bolts, couplings and the mounting of the accelerometers; turn the gear by hand with "
              "torque off and listen for ratcheting or a worn bearing. Confirm when the cause is mended."},
    AlarmKind{"twist_limit", AlarmPriority::kHigh, true,
              "Look at the brake of the input and at the couplings for slip; then at the gear for "
              "ratcheting. Confirm when the cause is mended."},
    AlarmKind{"stale_readings", AlarmPriority::kHigh, false,
              "Look at the cable, the supply and the program of the device whose channel is named; "
              "strainwave bench check shows what it sends."},
    AlarmKind{"implausible_reading", AlarmPriority::kHigh, false,
              "Look at the sensor that is named, at its cable and its supply; strainwave bench check shows "
              "what it sends."},
    AlarmKind{"input_angle_apart", AlarmPriority::kHigh, false,
              "Look at the coupling of the input encoder and at its set screw; turn the shaft by hand with "
              "torque off and compare both positions."},
    AlarmKind{
        "drive_fault", AlarmPriority::kHigh, false,
        "Read the fault on the drive's own display or program, and mend its cause before the next run."},
    AlarmKind{"drive_not_ready", AlarmPriority::kMedium, false,
              "Look at the drive's supply, its enable input, safe torque off and the emergency stop."},
    AlarmKind{"drive_silent", AlarmPriority::kHigh, false,
              "Look at the cable, the terminators and the supply of the drive's bus; strainwave devices "
              "lists who answers."},
    AlarmKind{"drive_dropped_out", AlarmPriority::kHigh, false,
              "Look at the drive's enable input, safe torque off, supply and watchdog, and at who pressed "
              "the emergency stop."},
    AlarmKind{"brake_engaged", AlarmPriority::kHigh, false,
              "Look at the brake's relay, its supply and its feedback; nobody turns the shaft against a "
              "brake that is on."},
    AlarmKind{"torque_away", AlarmPriority::kMedium, false,
              "Look at the load servo's torque limit and current, and at the couplings for slip."},
    AlarmKind{"speed_away", AlarmPriority::kMedium, false,
              "Look at the driving servo's speed and torque limits, and whether the gear turns freely with "
              "torque off."},
    AlarmKind{"position_away", AlarmPriority::kMedium, false,
              "Look at the driving servo's limits and at the couplings for slip."},
    AlarmKind{"torque_factor", AlarmPriority::kMedium, false,
              "Compare load_reducer_ratio, the drive's profile, and factor and sign of the torque transducer "
              "with what is mounted."},
    AlarmKind{"torque_of_check", AlarmPriority::kMedium, false,
              "Compare load_reducer_ratio, the drive's profile and the factor of the torque transducer with "
              "what is mounted."},
    AlarmKind{"speed_factor", AlarmPriority::kMedium, false,
              "Compare counts_per_rev and sign of the input encoder, and the units of the drive's profile, "
              "with what is mounted."},
    AlarmKind{"phase_timeout", AlarmPriority::kMedium, false,
              "Look in the journal at what the phase waited for; a drive that turns too slowly, or a "
              "temperature that is never reached."},
    AlarmKind{
        "torque_at_rest", AlarmPriority::kMedium, false,
        "Free the shafts and see whether the transducer shows zero; if it does not, set its zero anew."},
    AlarmKind{
        "reference_check", AlarmPriority::kMedium, false,
        "Ask who turned a shaft or a coupling; where nobody did, look at the encoders' cables and supply."},
    AlarmKind{"sensor_check", AlarmPriority::kMedium, false,
              "Look at the sensor that is named: mounting, cable, calibration. The check is run again with "
              "the next run."},
    AlarmKind{"log_full", AlarmPriority::kMedium, false,
              "The phase took longer than planned: look at its duration and log_rate in the schedule."},
    AlarmKind{"did_not_cool", AlarmPriority::kMedium, false,
              "Look at cooling and room temperature, and at suspend.resume_temperature: the room must be "
              "cooler than that."},
    AlarmKind{"sensor_stayed_bad", AlarmPriority::kMedium, false,
              "Look at the sensor that is named, its cable and its supply; then go on."},
    AlarmKind{"no_values", AlarmPriority::kMedium, false,
              "Look at the supply and the cables of the devices that are named; strainwave bench check shows "
              "what each sends."},
    AlarmKind{"disk_fills", AlarmPriority::kMedium, false,
              "Make room on the disk, or move it elsewhere, before it is full; strainwave status says when "
              "that will be."},
    AlarmKind{"disk_full", AlarmPriority::kMedium, false, "Make room on the disk, then go on with --resume."},
    AlarmKind{"stop_criterion", AlarmPriority::kLow, false,
              "The test has ended as the schedule has it: look at the trend, then take the reducer off or "
              "give it more cycles."},
};

const AlarmRule* FindRule(std::string_view code, std::span<const AlarmRule> rules) {
  const auto rule = std::ranges::find(rules, code, &AlarmRule::code);
  return rule == rules.end() ? nullptr : &*rule;
}

}  // namespace

constinit const std::span<const AlarmKind> kAlarmKinds{kKinds};

std::string_view Name(AlarmPriority priority) {
  switch (priority) {
    case AlarmPriority::kLow:
      return "low";
    case AlarmPriority::kMedium:
      return "medium";
    case AlarmPriority::kHigh:
      return "high";
  }
  return "";
}

std::optional<AlarmPriority> AlarmPriorityNamed(std::string_view name) {
  for (const AlarmPriority priority : {AlarmPriority::kLow, AlarmPriority::kMedium, AlarmPriority::kHigh}) {
    if (Name(priority) == name) return priority;
  }
  return std::nullopt;
}

AlarmKind KindOf(std::string_view code) {
  const auto kind = std::ranges::find(kAlarmKinds, code, &AlarmKind::code);
  return kind == kAlarmKinds.end() ? AlarmKind{code, AlarmPriority::kMedium, false} : *kind;
}

AlarmPriority PriorityOf(std::string_view code, std::span<const AlarmRule> rules) {
  const AlarmRule* const rule = FindRule(code, rules);
  return rule != nullptr && rule->priority ? *rule->priority : KindOf(code).priority;
}

bool IsLatching(std::string_view code, std::span<const AlarmRule> rules) {
  const AlarmRule* const rule = FindRule(code, rules);
  return rule != nullptr && rule->latching ? *rule->latching : KindOf(code).latching;
}

std::string GuidanceOf(std::string_view code, std::span<const AlarmRule> rules) {
  const AlarmRule* const rule = FindRule(code, rules);
  return rule != nullptr && !rule->guidance.empty() ? rule->guidance : std::string(KindOf(code).guidance);
}

}  // namespace strainwave::bench
