// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/hid/pendant_state.h"

namespace strainwave::bench {

PendantState NextPendantState(PendantState state, const PendantKeys& before, const PendantKeys& now) {
  if (now.quick_stop) return PendantState::kStopped;
  const bool resets = now.reset && !before.reset && !now.start;
  const bool starts = now.start && !before.start && !now.reset;
  switch (state) {
    case PendantState::kStopped:
      // The key that came up in the same report as another went down was not looked at in between.
      return resets && !before.quick_stop ? PendantState::kReset : state;
    case PendantState::kReset:
      return starts ? PendantState::kReleased : state;
    case PendantState::kReleased:
      return state;
  }
  return PendantState::kStopped;
}

}  // namespace strainwave::bench
