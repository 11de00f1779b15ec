// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/moving_limits.h"

#include <stdexcept>

#include <fmt/format.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {

double OptionQuantity(const char* option, const std::string& text, schedules::Dimension dimension) {
  try {
    return schedules::ParseQuantity(text, dimension);
  } catch (const std::invalid_argument& error) {
    throw BenchError(ExitCode::kWrongInput, fmt::format("{} {}: error: {}", option, text, error.what()));
  }
}

double TorqueLimit_Nm(const std::string& text, const BenchDescription& bench) {
  const double torque_Nm = OptionQuantity("--torque", text, schedules::Dimension::kTorque);
  if (torque_Nm > 0.0 && torque_Nm <= bench.transducer.range_Nm) return torque_Nm;
  throw BenchError(ExitCode::kWrongInput,
                   fmt::format("--torque {}: error: not a limit for this bench (expected above 0 and up "
                               "to {:g} Nm, the range of its torque transducer)",
                               text, bench.transducer.range_Nm));
}

}  // namespace strainwave::bench
