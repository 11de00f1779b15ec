// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "bench/configuration/bench_description.h"
#include "bench/roles/ask_operator.h"
#include "bench/roles/bench_machine.h"

namespace strainwave::bench {

/// What a simulated bench must know of the test besides its own file.
struct SimulatedTest {
  double ratio{80.0};
  /// Standstills at which the truth of the transmission error is told: those of the sweep.
  double sweep_step_rad{};
  int sweep_steps{};
  double pace{1.0};  // times real time; infinity: as fast as it can
  std::filesystem::path
      truth;  // file that gets one row a cycle of what only the simulation knows; empty: none
};

/// The bench that a bench file describes.
/// @param test  for a simulated bench. Rows are added to the truth file; of two with one cycle number the
///   last counts.
/// @param ask   what a person at a real bench must do by hand.
/// @throws BenchError for a real bench whose devices are not there or refuse; BenchFileError for files that
///   cannot be used, and for a plant term or a parameter that there is not.
std::unique_ptr<BenchMachine> MakeMachine(const BenchDescription& description, const SimulatedTest& test,
                                          const AskOperator& ask = {});

}  // namespace strainwave::bench
