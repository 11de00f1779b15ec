// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/version.h"

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"
#include "daq/software.h"

namespace strainwave::bench {

std::optional<int> AnswerVersion(int argc, const char* const* argv) {
  const std::span all(argv, static_cast<std::size_t>(argc));
  if (all.empty()) return std::nullopt;
  const auto arguments = all.subspan(1);
  const auto end = std::ranges::find(arguments, std::string_view("--"));
  const auto asked = std::ranges::any_of(arguments.begin(), end, [](std::string_view argument) {
    return argument == "--version" || argument.starts_with("--version=");
  });
  if (!asked) return std::nullopt;
  if (arguments.size() == 1 && arguments[0] == std::string_view("--version")) {
    ToStdout("{}\n", daq::Software());
    return static_cast<int>(ExitCode::kDone);
  }
  const std::string others = fmt::format("{}", fmt::join(arguments, " "));
  ToStderr("error: '{}': --version stands beside something else (expected '{} --version' alone)\n", others,
           std::filesystem::path(all[0]).filename().string());
  return static_cast<int>(ExitCode::kWrongInput);
}

}  // namespace strainwave::bench
