// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// One row a complete cycle as CSV, for a spreadsheet, R, Python: `cycle`, `started_h` and `ended_h` (bench
/// time), `load_h` (credited so far), then each quantity that any cycle has with its standard error
/// (`k1_Nm_per_rad`, `k1_Nm_per_rad_se`), and `flags`: why results are doubtful, in words, in quotes. A cell
/// without a value is empty.
struct CycleTable {
  std::string csv;
  int rows{};
  int columns{};
};
CycleTable CycleTableOf(const Journal& journal);

}  // namespace strainwave::bench
