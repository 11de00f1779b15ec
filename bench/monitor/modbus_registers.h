// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "bench/monitor/monitor_result.h"

namespace strainwave::bench {

/// The input registers (function 4) that a PLC reads. Numbers of two registers have the high word first:
/// floats are IEEE 754 single, NaN while the status is not good.
///
///    0  version of this table, 1
///    1  status: `ValueStatus` (1 is good; 3 is stale)
///    2  highest alarm: `AlarmLevel`
///    3  what is wrong with the window: `SignalFaultKind`, 0 nothing
///    4  number of the window, 2 registers
///    6  its end, seconds since 1970, UTC, 2 registers
///    8  distance from the training, float (above 1: outside; also while the status is 4)
///   10  age of the values in seconds, at most 65535
///   11  number of outputs
///   12  of classes: the likeliest, from 1; else 0
///   13  seconds since 1970, their low 16 bits: counts on as long as anybody answers, whatever the windows do
///   20 + 8 k, for output k in the predictor's order:
///        0 value, float; 2 low, float; 4 high, float; 6 alarm; 7 status
std::vector<std::uint16_t> ModbusRegisters(const MonitorState& state, const MonitorFrame& frame,
                                           std::int64_t now_ms);

inline constexpr std::size_t kFirstOutputRegister = 20;
inline constexpr std::size_t kRegistersPerOutput = 8;

}  // namespace strainwave::bench
