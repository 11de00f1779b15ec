// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/configuration/bench_description.h"
#include "schedules/reader/quantity.h"

namespace strainwave::bench {

/// Of the gear, where a command moves a shaft and no schedule says.
inline constexpr double kGearTemperatureLimit_degC = 80.0;

/// The value of an option such as --speed "2 rpm", in SI units. @throws BenchError naming the option.
double OptionQuantity(const char* option, const std::string& text, schedules::Dimension dimension);

/// The value of --torque, the output torque at which a movement ends. @throws BenchError for one that the
/// bench's torque transducer cannot measure.
double TorqueLimit_Nm(const std::string& text, const BenchDescription& bench);

}  // namespace strainwave::bench
