// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/checkout.h"
#include "tests/simulation/device_fault_rows.h"

namespace strainwave::bench {

/// A phase of the kinds that a schedule has.
struct TestedPhase {
  const char* name;
  double input_speed_rpm;  // the most that it turns with: what a stop has to take away; 0: it stands
  double input_stands_s;   // the longest that it does while it is used
  bool moves_to_positions;
  double asks_torque_after_s;  // of the load servo more than a shortfall leaves; below zero: never
  bool uses_load_servo;
  int beat;            // the second in which the fault comes: by then the phase does what it is there for
  int shortfall_beat;  // the same of a servo that gives less than it is asked for; 0: from the start

  bool uses_driving_servo() const { return input_speed_rpm > 0.0; }
  bool uses(BenchServo servo) const {
    return servo == BenchServo::kDriving ? uses_driving_servo() : uses_load_servo;
  }
};

// At each lock: the torque there and back both ways, and the drives brought up again.
inline constexpr double kLocked_s = 6.0 * 34.0 / 20.0 + 4.0 * 0.5 + 3.0;
// A drive that comes up, and two periods of the zero check's dither.
inline constexpr double kDithers_s = 3.0 + 2.0;

// First those that campaigns of tests repeat in every cycle.
inline constexpr TestedPhase kPhases[] = {
    {"load_run", 2400.0, 0.0, false, 0.0, true, 3, 3},
    {"measurement_rotation", 2400.0, 0.0, false, 0.0, true, 3, 3},
    {"transmission_error", 300.0, 0.15, true, -1.0, true, 3, 3},
    {"hysteresis", 300.0, kLocked_s, true, kLocked_s, true, 3, 3},
    {"soak", 0.0, 0.0, false, -1.0, false, 3, 3},
    {"blank_test", 20.0, kLocked_s, true, kLocked_s, true, 3, 3},
    {"zero_check", 0.0, 0.0, false, kDithers_s, true, 3, 0},
    {"shunt_check", 0.0, 0.0, false, -1.0, false, 8, 8},  // the shunt is on
    {"reference_check", 0.0, 0.0, false, -1.0, false, 3, 3},
};
inline constexpr std::size_t kPhasesOfEveryCycle = 4;

/// A driving servo on Modbus does not move to positions.
inline bool RunsOn(TestedBench bench, const TestedPhase& phase) {
  return bench != TestedBench::kModbus || !phase.moves_to_positions;
}

/// The bench file whose devices have the fault.
inline std::filesystem::path BenchFileOf(TestedBench bench) {
  constexpr const char* kFiles[] = {"bench.yaml", "modbus.yaml", "modbus_load.yaml"};
  return std::filesystem::path(SourceFolder()) / "tests/simulation/field" /
         kFiles[static_cast<std::size_t>(bench)];
}

/// Whether the fault ends this phase; else the next one that uses the servo, or none.
inline bool ShowsIn(const Fault& fault, const TestedPhase& phase) {
  switch (fault.shows) {
    case Shows::kAlways:
      return true;
    case Shows::kOnceUsed:
    case Shows::kWhileUsed:
      return phase.uses(fault.servo);
    case Shows::kOnceTheInputTurns:
    case Shows::kOnceSpeedIsAsked:
      return phase.uses_driving_servo();
    case Shows::kOnceTorqueIsAsked:
      return phase.asks_torque_after_s >= 0.0;
  }
  return true;
}

/// What the phase, or the one after it, ends with.
inline StopCause CauseIn(const Fault& fault, const TestedPhase& phase) {
  if (fault.shows == Shows::kOnceSpeedIsAsked && phase.moves_to_positions) return StopCause::kPositionAway;
  if (phase.uses(fault.servo)) return fault.cause;
  if (fault.shows == Shows::kWhileUsed) return StopCause::kNone;
  return fault.cause_while_off == StopCause::kNone ? fault.cause : fault.cause_while_off;
}

/// With the speed that is left of the phase's own: a quarter, and between positions, where a drive has time
/// to come after, a twentieth.
inline std::string CommandIn(const Fault& fault, const TestedPhase& phase) {
  const double speed_rpm = phase.uses_driving_servo() ? phase.input_speed_rpm : kPhases[0].input_speed_rpm;
  return fmt::format(fmt::runtime(fault.command), (phase.moves_to_positions ? 0.05 : 0.25) * speed_rpm);
}

/// The second of the phase in which the fault comes.
inline int BeatIn(const Fault& fault, const TestedPhase& phase) {
  const bool is_shortfall =
      fault.shows == Shows::kOnceSpeedIsAsked || fault.shows == Shows::kOnceTorqueIsAsked;
  return is_shortfall ? phase.shortfall_beat : phase.beat;
}

/// Seconds from the fault until the bench has noticed and both shafts are safe. What is noticed waits for the
/// next control period, and the order for the SYNC after next or the next write; five times that, as the
/// machine computes for others too. Then a drive on CAN brakes down its ramp; one on Modbus takes its torque
/// off at once.
inline double StatedTime_s(const Fault& fault, const TestedPhase& phase) {
  const bool is_while_off = fault.cause_while_off != StopCause::kNone && !phase.uses(fault.servo);
  const double noticed_after_s = is_while_off ? kReadings_s : fault.noticed_after_s;
  const bool waits_for_motion =
      fault.shows == Shows::kOnceTheInputTurns || fault.shows == Shows::kOnceSpeedIsAsked;
  const double stands_s = waits_for_motion                           ? phase.input_stands_s
                          : fault.shows == Shows::kOnceTorqueIsAsked ? phase.asks_torque_after_s
                                                                     : 0.0;
  const double way_s = fault.bench == TestedBench::kCan ? 2.0 * kSyncPeriod_s : kWritePeriod_s;
  const double order_s = 5.0 * (kControlPeriod_s + way_s);
  const double ramp_s = fault.bench == TestedBench::kModbus
                            ? 0.0
                            : RadPerSFromRpm(phase.input_speed_rpm) / kDeceleration_rad_per_s2;
  return noticed_after_s + stands_s + order_s + ramp_s;
}

/// A fault in a phase; by its numbers, so that a test has a name.
struct FaultInPhase {
  std::size_t fault{};
  std::size_t phase{};
};

inline std::string NameOfCell(const testing::TestParamInfo<FaultInPhase>& info) {
  std::string name;
  for (const std::string_view text :
       {std::string_view(Faults()[info.param.fault].name), std::string_view("_during_"),
        std::string_view(kPhases[info.param.phase].name)}) {
    for (const char letter : text) name += letter == ' ' || letter == '-' ? '_' : letter;
  }
  for (const char left_out : {'\'', ',', '(', ')'}) std::erase(name, left_out);
  return name;
}

/// Every fault in each of the first `phases` with STRAINWAVE_FAULT_MATRIX=1; else those that `one_of_few`
/// takes. A phase that the fault's bench cannot run is left out.
inline std::vector<FaultInPhase> FaultsInPhases(std::size_t phases, bool (*one_of_few)(FaultInPhase)) {
  const bool all = std::getenv("STRAINWAVE_FAULT_MATRIX") != nullptr;
  std::vector<FaultInPhase> pairs;
  for (std::size_t phase = 0; phase < phases; ++phase) {
    for (std::size_t fault = 0; fault < Faults().size(); ++fault) {
      if (!RunsOn(Faults()[fault].bench, kPhases[phase])) continue;
      if (all || one_of_few({fault, phase})) pairs.push_back({fault, phase});
    }
  }
  return pairs;
}

}  // namespace strainwave::bench
