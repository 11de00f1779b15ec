// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace strainwave::bench {

/// The program that computes a plan's results.
struct FleetProgram {
  std::string run;       // what is started for each input
  std::string software;  // as `strainwave --version` says it
  std::string sha256;    // of its file
};

/// This very program: what is started is its open file, also where another one has taken its name since.
/// @throws std::system_error.
FleetProgram ThisProgram();

/// Where this program lies, for other machines. @throws std::filesystem::filesystem_error.
std::string PathOfThisProgram();

}  // namespace strainwave::bench
