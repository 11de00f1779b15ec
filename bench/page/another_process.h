// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace strainwave::bench {

/// Starts this program once more: in a session of its own, so that it outlives this process and hears no
/// signal of its terminal, without standard input. @param words  of the command line, after the program's
/// name; @param output  gets what it says, at the file's end. @throws std::system_error.
pid_t StartAnother(std::vector<std::string> words, const std::filesystem::path& output);

/// Empty where there is no such file.
std::string LastLineOf(const std::filesystem::path& file);

}  // namespace strainwave::bench
