// SPDX-License-Identifier: Apache-2.0
#include "bench/realtime/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

#include <fmt/core.h>

namespace strainwave::bench {

namespace {

// Once for the whole program, and all of it: the way of a stop has not been gone before it is needed, and
// must not wait for a disk then.
int KeepMemory() {
  static const int error = mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
  return error;
}

}  // namespace

std::string BecomeRealtime(RealtimeRank rank) {
  sched_param parameters{};
  parameters.sched_priority = static_cast<int>(rank);
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters); error != 0) {
    return fmt::format(
        "a cyclic thread runs without real-time priority: {} (expected CAP_SYS_NICE, or an rtprio of {} in "
        "/etc/security/limits.conf)",
        std::strerror(error), static_cast<int>(rank));
  }
  if (const int error = KeepMemory(); error != 0) {
    return fmt::format(
        "its memory may be paged out: {} (expected CAP_IPC_LOCK, or memlock unlimited in "
        "/etc/security/limits.conf)",
        std::strerror(error));
  }
  return {};
}

}  // namespace strainwave::bench
