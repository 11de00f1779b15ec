// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace strainwave::bench {

/// Starts this program once more: in a session of its own, so that it outlives this process and hears no
/// signal of its terminal, without standard input. @param words  of the command line, after the program's
/// name; @param output  gets what it says, at the file's end. @throws std::system_error.
pid_t StartAnother(std::vector<std::string> words, const std::filesystem::path& output);

enum class Awaited { kDone, kEnded, kNothing };

/// Waits until a process has done something, by a file that it writes: sleeps until the file changes, the
/// process ends, or the time is over.
/// @param process  a child of this one, which is waited for (waitpid) when it has ended
/// @param file     in a folder that is there
/// @param is_done  asked at the beginning, after every change of the file, and when the process has ended
Awaited Await(pid_t process, const std::filesystem::path& file, std::chrono::seconds patience,
              const std::function<bool()>& is_done);

/// Empty where there is no such file.
std::string LastLineOf(const std::filesystem::path& file);

}  // namespace strainwave::bench
