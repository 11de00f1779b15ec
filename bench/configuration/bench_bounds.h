// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "schedules/reader/bounds.h"

namespace strainwave::bench {

/// How far the values of a bench file may go, each by itself, and those of the files of its devices: profiles
/// of drives, registers of Modbus devices, reports of HID devices.
std::span<const schedules::QuantityBound> BenchBounds();
std::span<const schedules::QuantityBound> DeviceBounds();

/// For how long nobody may look at a shaft that turns: readings that are old, a drive or a watchdog that says
/// nothing.
inline constexpr double kLongestUnwatched_s = 2.0;

}  // namespace strainwave::bench
