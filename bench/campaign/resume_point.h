// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "bench/campaign/checkpoint.h"
#include "bench/campaign/pause.h"

namespace strainwave::bench {

/// On whose word a campaign goes on.
struct ResumeOrder {
  std::string by;       // a person; empty where `restart` is not 0
  bool accept_pause{};  // one longer than the schedule allows, or not known
  /// Runs that have begun without a person since a person's last, this one among them; 0: a person's order.
  int restart{};
};

/// Where an earlier run of a campaign was when it ended; as it stands: there was none.
struct ResumePoint {
  std::optional<Checkpoint> checkpoint{};  // none where no phase had begun
  Pause pause{0.0, ""};
  double time_s{};  // bench time: the latest in checkpoint and journal
};

}  // namespace strainwave::bench
