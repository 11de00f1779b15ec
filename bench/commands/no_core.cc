// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/no_core.h"

#include <sys/resource.h>

namespace strainwave::bench {

// The soft limit alone: a program that is started from here may raise its own again.
void LeaveNoCore() noexcept {
  rlimit core{};
  if (::getrlimit(RLIMIT_CORE, &core) != 0) return;
  core.rlim_cur = 0;
  ::setrlimit(RLIMIT_CORE, &core);
}

}  // namespace strainwave::bench
