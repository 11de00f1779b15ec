// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/controller/stop_reason.h"

namespace strainwave::bench {

// How long the bench may take to notice, by what tests/simulation/field, the register map of its thermometers
// and TestSettings say; StatedTimes.AreThoseOfTheFiles holds them against each other.
inline constexpr double kHeartbeat_s = 1.2;  // a drive's, waited for
inline constexpr double kReadings_s = 1.0;   // none, and the values of a stream that has fallen silent
inline constexpr double kPoll_s = 0.2;       // of a thermometer
inline constexpr double kGoodFor_s = 2.0;    // what a thermometer has said last
inline constexpr double kBadSensor_s = 2.0;  // borne before the run is suspended
inline constexpr double kFound_s = 2.0;      // a sensor that tells nothing new (BENCH row 22)
inline constexpr double kControlPeriod_s = 0.010;
inline constexpr double kSyncPeriod_s = 0.004;
inline constexpr double kDeceleration_rad_per_s2 = 5000.0;  // of a quick stop
inline constexpr double kTorqueLimit_Nm = 60.0;             // Nm
inline constexpr double kTrip_degC = 70.0;                  // degC
inline constexpr double kMostTorque_Nm = 40.0;              // Nm, the most, either way
inline constexpr double kColdest_degC = 20.0;               // degC
inline constexpr double kAtOnce_s = 0.0;                    // the drive itself says so

/// When the bench can know of a fault at all.
enum class Shows {
  kAlways,
  // A drive that has torque off and its brake on may also have its safe torque off open, or say that it is in
  // no state: a person may be at the shafts. It is asked again when it is to be enabled.
  kOnceTheDrivingServoIsUsed,
  kOnceTheLoadServoIsUsed,
  kOnceTheInputTurns,  // a shaft that stands is not told from an encoder that repeats its last value
};

/// A fault that the device side is told to have, and what the bench should come to know of it.
struct Fault {
  const char* name;
  const char* command;
  StopCause cause;
  const char* words;       // among those that a technician reads
  const char* mend;        // the command that takes it away again, where the bench waits for that
  double noticed_after_s;  // at most
  Shows shows{Shows::kAlways};
};

// Named as the rows of the README's table are.
inline constexpr Fault kFaults[] = {
    {"heartbeat stops", "drive 1 heartbeat off", StopCause::kDriveFault, "heartbeat is lost", "",
     kHeartbeat_s},
    // While the servo is used, its process data are missed sooner.
    {"drive falls silent", "drive 2 silent on", StopCause::kDriveFault, "node 2", "", kHeartbeat_s},
    {"drive reboots", "drive 1 reboot", StopCause::kDriveFault, "started anew", "", kAtOnce_s},
    {"emergency message", "drive 2 emergency 0x4310", StopCause::kDriveFault, "4310", "", kAtOnce_s},
    {"safe torque off opens", "drive 1 sto on", StopCause::kDriveFault, "safe torque off is open", "",
     kAtOnce_s, Shows::kOnceTheDrivingServoIsUsed},
    {"statusword of no state", "drive 2 statusword 0x4440", StopCause::kDriveFault, "node 2", "", kAtOnce_s,
     Shows::kOnceTheLoadServoIsUsed},
    {"drive's bus-off", "drive 1 bus-off on", StopCause::kDriveFault, "node 1", "", kAtOnce_s},
    {"encoder stream falls silent", "stream encoders silent on", StopCause::kStaleReadings,
     "no fresh readings", "", kReadings_s},
    {"3000 encoder samples are lost", "stream encoders drop 3000", StopCause::kStaleReadings,
     "no fresh readings", "", kReadings_s},
    {"thermometer does not answer", "modbus thermometers silence", StopCause::kSensorSuspend, "temperature",
     "modbus thermometers ok", kGoodFor_s + kBadSensor_s},
    {"thermometer answers late", "modbus thermometers delay 1500", StopCause::kSensorSuspend, "temperature",
     "modbus thermometers ok", kGoodFor_s + kBadSensor_s},
    {"thermometer refuses", "modbus thermometers exception 4", StopCause::kSensorSuspend, "temperature",
     "modbus thermometers ok", kPoll_s + kBadSensor_s},
    {"thermometer sends half answers", "modbus thermometers half", StopCause::kSensorSuspend, "temperature",
     "modbus thermometers ok", kGoodFor_s + kBadSensor_s},
    {"another unit answers for the thermometer", "modbus thermometers unit", StopCause::kSensorSuspend,
     "temperature", "modbus thermometers ok", kGoodFor_s + kBadSensor_s},
    {"thermometer answers another question", "modbus thermometers transaction", StopCause::kSensorSuspend,
     "temperature", "modbus thermometers ok", kGoodFor_s + kBadSensor_s},
    {"thermometer drifts by 20 K a second", "modbus thermometers drift 0 20", StopCause::kTemperatureSuspend,
     "temperature", "modbus thermometers drift 0 0", (kTrip_degC - kColdest_degC) / 20.0 + kPoll_s},
    {"torque transducer repeats its last value", "sensor freeze 3", StopCause::kImplausibleReading,
     "output torque", "", kFound_s},
    {"torque transducer drifts by 40 Nm a second", "sensor drift 3 40", StopCause::kOutputTorqueLimit,
     "output torque", "", (kTorqueLimit_Nm + kMostTorque_Nm) / 40.0},
    {"output encoder repeats its last value", "sensor freeze 1", StopCause::kImplausibleReading,
     "output angle", "", kFound_s},
    {"input encoder repeats its last value", "sensor freeze 0", StopCause::kInputAngleApart, "input angle",
     "", kFound_s, Shows::kOnceTheInputTurns},
    {"accelerometers fall silent", "stream accelerometers silent on", StopCause::kSensorSuspend, "vibration",
     "stream accelerometers silent off", kReadings_s + kBadSensor_s},
    {"accelerometers repeat their last value", "sensor freeze 7", StopCause::kSensorSuspend, "vibration",
     "sensor freeze off", kFound_s + kBadSensor_s},
    {"accelerometers are dead", "sensor dead 7", StopCause::kSensorSuspend, "vibration", "sensor dead off",
     kBadSensor_s},
    {"gear gets hot", "gear temperature 90", StopCause::kGearTemperatureLimit, "gear temperature", "",
     kPoll_s},
};

/// A phase of the kinds that a schedule has.
struct TestedPhase {
  const char* name;
  double input_speed_rpm;  // the most that it turns with: what a stop has to take away; 0: it stands
  double input_stands_s;   // the longest that it does while it is used
  bool uses_load_servo;
  int beat;  // the second in which the fault comes: by then the phase does what it is there for

  bool uses_driving_servo() const { return input_speed_rpm > 0.0; }
};

// At each lock: the torque there and back both ways, and the drives brought up again.
inline constexpr double kLocked_s = 6.0 * 34.0 / 20.0 + 4.0 * 0.5 + 3.0;

// First those that campaigns of tests repeat in every cycle.
inline constexpr TestedPhase kPhases[] = {
    {"load_run", 2400.0, 0.0, true, 3},
    {"measurement_rotation", 2400.0, 0.0, true, 3},
    {"transmission_error", 300.0, 0.15, true, 3},
    {"hysteresis", 300.0, kLocked_s, true, 3},
    {"soak", 0.0, 0.0, false, 3},
    {"blank_test", 20.0, kLocked_s, true, 3},
    {"zero_check", 0.0, 0.0, true, 3},
    {"shunt_check", 0.0, 0.0, false, 8},  // the shunt is on
    {"reference_check", 0.0, 0.0, false, 3},
};
inline constexpr std::size_t kPhasesOfEveryCycle = 4;

/// Whether the fault ends this phase, or the next one that uses the servo.
inline bool ShowsIn(const Fault& fault, const TestedPhase& phase) {
  switch (fault.shows) {
    case Shows::kAlways:
      return true;
    case Shows::kOnceTheDrivingServoIsUsed:
    case Shows::kOnceTheInputTurns:
      return phase.uses_driving_servo();
    case Shows::kOnceTheLoadServoIsUsed:
      return phase.uses_load_servo;
  }
  return true;
}

/// Seconds from the fault until the bench has noticed and both shafts are safe. What is noticed waits for the
/// next control period, and the order for the SYNC after next; five times that, as the machine computes for
/// others too. Then the drive brakes down its ramp.
inline double StatedTime_s(const Fault& fault, const TestedPhase& phase) {
  const double stands_s = fault.shows == Shows::kOnceTheInputTurns ? phase.input_stands_s : 0.0;
  const double order_s = 5.0 * (kControlPeriod_s + 2.0 * kSyncPeriod_s);
  const double ramp_s = RadPerSFromRpm(phase.input_speed_rpm) / kDeceleration_rad_per_s2;
  return fault.noticed_after_s + stands_s + order_s + ramp_s;
}

/// A fault in a phase; by its numbers, so that a test has a name.
struct FaultInPhase {
  std::size_t fault{};
  std::size_t phase{};
};

inline std::string NameOf(const testing::TestParamInfo<FaultInPhase>& info) {
  std::string name;
  for (const std::string_view text :
       {kFaults[info.param.fault].name, "_during_", kPhases[info.param.phase].name}) {
    for (const char letter : text) name += letter == ' ' || letter == '-' ? '_' : letter;
  }
  std::erase(name, '\'');
  return name;
}

/// Every fault in each of the first `phases` with STRAINWAVE_FAULT_MATRIX=1; else those that `one_of_few`
/// takes.
inline std::vector<FaultInPhase> FaultsInPhases(std::size_t phases, bool (*one_of_few)(FaultInPhase)) {
  const bool all = std::getenv("STRAINWAVE_FAULT_MATRIX") != nullptr;
  std::vector<FaultInPhase> pairs;
  for (std::size_t phase = 0; phase < phases; ++phase) {
    for (std::size_t fault = 0; fault < std::size(kFaults); ++fault) {
      if (all || one_of_few({fault, phase})) pairs.push_back({fault, phase});
    }
  }
  return pairs;
}

}  // namespace strainwave::bench
