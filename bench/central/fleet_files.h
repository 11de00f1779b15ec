// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "bench/page/static_files.h"

namespace strainwave::bench {

/// The files of the page of all benches, as they were when the program was built (cmake/embed.cmake).
std::span<const StaticFile> FleetFiles();

}  // namespace strainwave::bench
