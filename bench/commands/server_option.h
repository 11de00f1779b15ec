// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace strainwave::bench {

/// --server, as libpq takes it. @param conninfo  outlives the command.
CLI::Option* AddServerOption(CLI::App& command, std::string& conninfo);

}  // namespace strainwave::bench
