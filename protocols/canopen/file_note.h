// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace strainwave::protocols::canopen {

/// Both from 1.
struct FilePlace {
  int line{};
  int column{};
};

/// What is odd about a file, with its place.
struct FileNote {
  int line{};
  int column{};
  std::string what;  // "WHAT (what was expected)"
};

}  // namespace strainwave::protocols::canopen
