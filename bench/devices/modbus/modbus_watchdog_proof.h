// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "bench/devices/modbus/modbus_link.h"
#include "bench/devices/modbus/modbus_servo_profile.h"
#include "bench/roles/bench_clock.h"

namespace strainwave::bench {

struct WatchdogProof {
  bool proven{};
  std::chrono::nanoseconds time_to_stop{};  // from the last write until the drive says that it is not enabled
  std::string words;                        // what was found, or why it is refused
};

/// Shows at commissioning that a drive stops by itself when nobody writes any more: enables it in torque mode
/// at zero torque with its brake on, then goes silent on writes while its state is still read. A watchdog
/// that reading alone keeps quiet would let a drive run on under a program that has lost its control loop:
/// that is found by being silent altogether then, and refused.
///
/// A fault that the drive is in before is reset, and so is the one that its watchdog ends in; what a reset
/// does not clear is refused with its code. The drive is off and braked at the end.
/// @param link  open, to the drive, which nobody else is connected to.
WatchdogProof ProveWatchdog(ModbusLink& link, const protocols::modbus::RegisterMap& map,
                            const ModbusServoProfile& profile, BenchClock& clock);

}  // namespace strainwave::bench
