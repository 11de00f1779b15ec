// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

/// Where the files are that a program needs beside itself: found from the program's own place, so that an
/// installed tree can be moved as a whole. packaging/README.md shows the tree.
namespace strainwave::bench {

/// The first of these that is there: `name` in the folder of modules as installed, beside the program, and
/// one folder higher (tests stand in a folder of their own); the first of the three where none is.
std::filesystem::path ModuleFile(const char* name);

/// A file or folder that comes with the program, by its path in a checkout ("bench/devices/profiles"): as
/// installed; in the current folder where the program is not.
std::filesystem::path DataFile(const char* name);

}  // namespace strainwave::bench
