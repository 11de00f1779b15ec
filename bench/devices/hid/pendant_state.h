// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace strainwave::bench {

/// Keys of an operator's pendant that are down. A pendant that is not there, or has not yet said what is
/// down, has its quick-stop key pressed.
struct PendantKeys {
  bool quick_stop{true};
  bool reset{true};  // taken for held, so that a key that is stuck at the start is no act of anyone
  bool start{true};

  bool operator==(const PendantKeys&) const = default;
};

/// Where the operator is between a stop and a start, which are two deliberate acts apart: reset, then start.
enum class PendantState : std::uint8_t {
  kStopped,   // by the key, or since the pendant was gone; also at the start
  kReset,     // the stop is acknowledged; nothing moves yet
  kReleased,  // start was pressed: the bench may run
};

/// What follows when the keys change from `before` to `now`. The quick-stop key wins over all others; reset
/// and start act when they go down, and only alone.
PendantState NextPendantState(PendantState state, const PendantKeys& before, const PendantKeys& now);

}  // namespace strainwave::bench
