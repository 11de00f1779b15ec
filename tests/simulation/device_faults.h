// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "bench/controller/stop_reason.h"

namespace strainwave::bench {

/// A fault that the device side is told to have, and what the bench should come to know of it.
struct Fault {
  const char* name;
  const char* command;
  StopCause cause;
  const char* words;  // among those that a technician reads
  const char* mend;   // the command that takes it away again, where the bench waits for that
};

// Named as the rows of the README's table are.
inline constexpr Fault kFaults[] = {
    {"heartbeat stops", "drive 1 heartbeat off", StopCause::kDriveFault, "heartbeat is lost", ""},
    {"drive falls silent", "drive 2 silent on", StopCause::kDriveFault, "node 2", ""},
    {"drive reboots", "drive 1 reboot", StopCause::kDriveFault, "started anew", ""},
    {"emergency message", "drive 2 emergency 0x4310", StopCause::kDriveFault, "4310", ""},
    {"safe torque off opens", "drive 1 sto on", StopCause::kDriveFault, "safe torque off is open", ""},
    {"statusword of no state", "drive 2 statusword 0x4440", StopCause::kDriveFault, "node 2", ""},
    {"drive's bus-off", "drive 1 bus-off on", StopCause::kDriveFault, "node 1", ""},
    {"encoder stream falls silent", "stream encoders silent on", StopCause::kStaleReadings,
     "no fresh readings", ""},
    {"3000 encoder samples are lost", "stream encoders drop 3000", StopCause::kStaleReadings,
     "no fresh readings", ""},
    {"thermometer does not answer", "modbus thermometers silence", StopCause::kSensorSuspend, "temperature",
     "modbus thermometers ok"},
    {"thermometer answers late", "modbus thermometers delay 1500", StopCause::kSensorSuspend, "temperature",
     "modbus thermometers ok"},
    {"thermometer refuses", "modbus thermometers exception 4", StopCause::kSensorSuspend, "temperature",
     "modbus thermometers ok"},
    {"thermometer sends half answers", "modbus thermometers half", StopCause::kSensorSuspend, "temperature",
     "modbus thermometers ok"},
    {"another unit answers for the thermometer", "modbus thermometers unit", StopCause::kSensorSuspend,
     "temperature", "modbus thermometers ok"},
    {"thermometer answers another question", "modbus thermometers transaction", StopCause::kSensorSuspend,
     "temperature", "modbus thermometers ok"},
    {"thermometer drifts by 20 K a second", "modbus thermometers drift 0 20", StopCause::kTemperatureSuspend,
     "temperature", "modbus thermometers drift 0 0"},
    {"torque transducer repeats its last value", "sensor freeze 3", StopCause::kImplausibleReading,
     "output torque", ""},
    {"torque transducer drifts by 40 Nm a second", "sensor drift 3 40", StopCause::kOutputTorqueLimit,
     "output torque", ""},
    {"output encoder repeats its last value", "sensor freeze 1", StopCause::kImplausibleReading,
     "output angle", ""},
    {"input encoder repeats its last value", "sensor freeze 0", StopCause::kInputAngleApart, "input angle",
     ""},
    {"accelerometers fall silent", "stream accelerometers silent on", StopCause::kSensorSuspend, "vibration",
     "stream accelerometers silent off"},
    {"accelerometers repeat their last value", "sensor freeze 7", StopCause::kSensorSuspend, "vibration",
     "sensor freeze off"},
    {"accelerometers are dead", "sensor dead 7", StopCause::kSensorSuspend, "vibration", "sensor dead off"},
    {"gear gets hot", "gear temperature 90", StopCause::kGearTemperatureLimit, "gear temperature", ""},
};

inline constexpr const char* kPhases[] = {"load_run", "measurement_rotation", "transmission_error",
                                          "hysteresis"};

/// A fault in a phase; by its numbers, so that a test has a name.
struct FaultInPhase {
  std::size_t fault{};
  std::size_t phase{};
};

inline std::string NameOf(const testing::TestParamInfo<FaultInPhase>& info) {
  std::string name;
  for (const std::string_view text :
       {kFaults[info.param.fault].name, "_during_", kPhases[info.param.phase]}) {
    for (const char letter : text) name += letter == ' ' || letter == '-' ? '_' : letter;
  }
  std::erase(name, '\'');
  return name;
}

/// Every fault in every phase with STRAINWAVE_FAULT_MATRIX=1; else those that `one_of_few` takes.
inline std::vector<FaultInPhase> FaultsInPhases(bool (*one_of_few)(FaultInPhase)) {
  const bool all = std::getenv("STRAINWAVE_FAULT_MATRIX") != nullptr;
  std::vector<FaultInPhase> pairs;
  for (std::size_t phase = 0; phase < std::size(kPhases); ++phase) {
    for (std::size_t fault = 0; fault < std::size(kFaults); ++fault) {
      if (all || one_of_few({fault, phase})) pairs.push_back({fault, phase});
    }
  }
  return pairs;
}

}  // namespace strainwave::bench
