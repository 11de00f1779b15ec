// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace strainwave::bench {

/// Of the option, in `--help`.
inline constexpr const char* kVersionHelp = "Print name, version and commit, and exit";

/// Writes the name, version and commit of this program (daq/software.h) where the command line asks for it.
/// @return the exit code; nothing where it does not ask: what stands behind `--` is no option.
std::optional<int> AnswerVersion(int argc, const char* const* argv);

}  // namespace strainwave::bench
