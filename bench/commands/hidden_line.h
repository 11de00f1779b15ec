// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace strainwave::bench {

/// Asks at the terminal of standard input, and reads a line that is not shown there. Whatever ends or stops
/// the program meanwhile (Ctrl-C, Ctrl-\, Ctrl-Z, SIGTERM, SIGHUP) finds the terminal as it was before, and
/// does to the program what it always does; after a stop it asks again. The signals must be at their default,
/// and no other thread may take them. Where standard input is no terminal, its next line is read and nothing
/// is asked.
/// @param question  "password of A. Meier: "
/// @return nothing at the end of the input.
std::optional<std::string> ReadHiddenLine(const std::string& question);

/// Whether somebody sits at standard input.
bool IsAtTerminal();

}  // namespace strainwave::bench
