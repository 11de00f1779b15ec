// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/reliability/lifetimes.h"

namespace strainwave::analysis::reliability {

/// Millions of revolutions to the failure of 23 deep-groove ball bearings: docs/sources.md#lieblein-1956.
inline std::vector<Lifetime> BallBearings() {
  std::vector<Lifetime> lives;
  for (const double time :
       {17.88, 28.92, 33.00, 41.52, 42.12, 45.60, 48.40,  51.84,  51.96,  54.12,  55.56, 67.80,
        68.64, 68.64, 68.88, 84.12, 93.12, 98.64, 105.12, 105.84, 127.92, 128.04, 173.40})
    lives.push_back(Lifetime::Failed(time));
  return lives;
}

}  // namespace strainwave::analysis::reliability
