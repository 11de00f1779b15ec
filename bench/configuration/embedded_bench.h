// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/configuration/bench_description.h"

namespace strainwave::bench {

/// The text of the bench that is used when none is given: a simulated one. It is a bench file like any other
/// and makes a good start for one's own.
const std::string& EmbeddedBenchText();

/// The same, read.
BenchDescription EmbeddedBench();

}  // namespace strainwave::bench
