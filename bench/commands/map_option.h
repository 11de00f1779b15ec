// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace strainwave::bench {

/// `--map FILE`, as every command has it that takes records.
void AddMapOption(CLI::App& command, std::string& map);

}  // namespace strainwave::bench
