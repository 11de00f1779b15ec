// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace strainwave::bench {

/// How another program ended.
struct ChildEnd {
  int error{};        // errno of the start; 0 where it started
  int exit_code{};    // of one that ended by itself
  int signal{};       // that ended it; 0 for none
  bool late{};        // it took longer than it may, and was ended with all that it had started
  std::string said;   // on both of its outputs, without the end of the last line
  std::string words;  // on its standard error, where the two are kept apart
};

/// Whether what a child says on its standard error stands among its output, or by itself.
enum class ChildOutputs { kTogether, kApart };

/// Runs a program of the PATH with its arguments and waits for it. It gets `input` as its standard input, and
/// signals as usual, however this program takes its own.
/// @param command  the program first
/// @param limit    ends it after that time; none: it may take as long as it likes
/// @throws std::system_error where there is no scratch file for its input and output.
ChildEnd RunChild(std::vector<std::string> command, const std::string& input,
                  std::optional<std::chrono::milliseconds> limit = std::nullopt,
                  ChildOutputs outputs = ChildOutputs::kTogether);

}  // namespace strainwave::bench
