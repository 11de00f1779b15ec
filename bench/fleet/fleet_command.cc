// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/fleet_command.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/errors/bench_error.h"
#include "bench/plots/child_program.h"

namespace strainwave::bench {
namespace {

using Takes = FleetOption::Takes;

template <typename T>
std::vector<std::string> NamesOf(const T& all) {
  std::vector<std::string> names;
  for (const auto& one : all) names.emplace_back(one.name);
  return names;
}

}  // namespace

std::span<const FleetCommand> FleetCommands() {
  static const std::array<FleetCommand, 3> kCommands{
      {{"recompute",
        {{"--method", Takes::kValue}, {"--calibrations", Takes::kFile}, {"--map", Takes::kFile}}},
       {"features",
        {{"--set", Takes::kValue},
         {"--wavelet", Takes::kValue},
         {"--levels", Takes::kValue},
         {"--mode", Takes::kValue},
         {"--motor-torque", Takes::kNothing},
         {"--map", Takes::kFile}}},
       {"diagnose",
        {{"--model", Takes::kFile},
         {"--kind", Takes::kValue},
         {"--group", Takes::kValue},
         {"--seed", Takes::kValue},
         {"--judge-by-simulation", Takes::kNothing},
         {"--power", Takes::kNothing},
         {"--map", Takes::kFile}}}}};
  return kCommands;
}

const FleetCommand& FleetCommandNamed(const std::string& name) {
  const auto commands = FleetCommands();
  const auto found = std::ranges::find(commands, std::string_view(name), &FleetCommand::name);
  if (found == commands.end())
    Refuse(name, "is no command that a fleet runs", fmt::format("{}", fmt::join(NamesOf(commands), ", ")));
  return *found;
}

std::vector<std::string> FilesOfOptions(const FleetCommand& command, std::span<const std::string> options) {
  std::vector<std::string> files;
  for (std::size_t i = 0; i < options.size(); ++i) {
    const std::string& word = options[i];
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const auto option = std::ranges::find(command.options, std::string_view(name), &FleetOption::name);
    if (option == command.options.end()) {
      Refuse(word, fmt::format("is no option of {} in a fleet", command.name),
             fmt::format("{}", fmt::join(NamesOf(command.options), ", ")));
    }
    std::string value;
    if (equals != std::string::npos) {
      value = word.substr(equals + 1);
    } else if (option->takes != Takes::kNothing) {
      if (i + 1 == options.size()) Refuse(word, "has no value", "one behind it");
      value = options[++i];
    }
    if (option->takes == Takes::kFile) files.push_back(std::move(value));
  }
  return files;
}

// The help of a command is told only when all values are as they may be.
void CheckValues(const FleetCommand& command, const std::vector<std::string>& options,
                 const FleetProgram& program) {
  std::vector<std::string> words{program.run, command.name};
  words.insert(words.end(), options.begin(), options.end());
  words.emplace_back("--help");
  const ChildEnd end = RunChild(std::move(words), "");
  if (end.error == 0 && end.signal == 0 && end.exit_code == 0) return;
  throw BenchError(ExitCode::kWrongInput, fmt::format("error: strainwave {}: {}", command.name,
                                                      end.said.substr(0, end.said.find('\n'))));
}

}  // namespace strainwave::bench
