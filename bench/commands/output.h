// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string_view>
#include <utility>

#include "bench/text.h"

namespace strainwave::bench {

/// Standard output takes results, standard error words. What cannot be written throws nothing, raises no
/// signal and stops nothing; `FinishOutput` tells of it.
enum class Output { kResults, kWords };

void Write(Output output, std::string_view text);

template <typename... T>
void ToStdout(fmt::format_string<T...> format, T&&... values) {
  Write(Output::kResults, Text(format, std::forward<T>(values)...));
}

template <typename... T>
void ToStderr(fmt::format_string<T...> format, T&&... values) {
  Write(Output::kWords, Text(format, std::forward<T>(values)...));
}

/// A line of standard error that is written anew in place and gives way to words, and to results on a
/// terminal; the newest alone counts, and an empty one takes it away. Nothing where standard error is no
/// terminal.
void ShowLine(std::string_view text);
bool StderrIsTerminal();

/// The first thing of a program: no file that it opens gets the number of a closed standard stream, and a
/// reader that is gone is an error of writing, not a signal.
void PrepareOutput();

/// While this lives, nobody waits for what reads the output: a thread for each of the two streams writes, as
/// much as a mebibyte of either waits, and what finds no room is dropped and counted. After it, words and
/// results are waited for again, but never for a terminal that takes nothing for a second, nor after a stop
/// was asked for.
class LiveOutput {
 public:
  enum class Results { kDropped, kWaitedFor };  // where there is no room for them

  explicit LiveOutput(std::function<bool()> stop_asked, Results results = Results::kWaitedFor);
  LiveOutput(const LiveOutput&) = delete;
  LiveOutput& operator=(const LiveOutput&) = delete;
  ~LiveOutput();
};

/// The last thing of a program: writes what still waits, and tells what could not be written, but for a pipe
/// that its reader has closed.
/// @return `code`; 3 for 0 where results could not be written and there was no LiveOutput, whose commands are
///   about more than their output.
int FinishOutput(int code);

}  // namespace strainwave::bench
