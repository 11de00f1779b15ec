// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/fleet/program.h"

namespace strainwave::bench {

/// An option of a command that keeps its meaning where each input is computed by itself.
struct FleetOption {
  const char* name;
  enum class Takes { kNothing, kValue, kFile } takes;
};

/// A command whose result of one input knows nothing of the others.
struct FleetCommand {
  const char* name;
  std::vector<FleetOption> options;
};

std::span<const FleetCommand> FleetCommands();

/// @throws BenchError for another name.
const FleetCommand& FleetCommandNamed(const std::string& name);

/// The files that the options name.
/// @throws BenchError for an option that the command does not have here, or one without its value.
std::vector<std::string> FilesOfOptions(const FleetCommand& command, std::span<const std::string> options);

/// Lets the program itself look at the values.
/// @throws BenchError with its words where it refuses one.
void CheckValues(const FleetCommand& command, const std::vector<std::string>& options,
                 const FleetProgram& program);

}  // namespace strainwave::bench
