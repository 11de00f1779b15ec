// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "bench/campaign/checkpoint.h"
#include "bench/campaign/pause.h"

namespace strainwave::bench {

/// Where an earlier run of a campaign was when it ended; as it stands: there was none.
struct ResumePoint {
  std::optional<Checkpoint> checkpoint{};  // none where no phase had begun
  Pause pause{0.0, ""};
  double time_s{};  // bench time: the latest in checkpoint and journal
};

}  // namespace strainwave::bench
