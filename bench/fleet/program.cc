// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/program.h"

#include <filesystem>

#include "bench/sha256.h"
#include "daq/software.h"

namespace strainwave::bench {
namespace {

constexpr const char* kOpenFile = "/proc/self/exe";

}  // namespace

FleetProgram ThisProgram() { return {kOpenFile, std::string(daq::Software()), Sha256OfFile(kOpenFile)}; }

std::string PathOfThisProgram() { return std::filesystem::read_symlink(kOpenFile).string(); }

}  // namespace strainwave::bench
