// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

#include <fmt/core.h>

namespace strainwave::bench {
namespace {

// Above every ordinary thread, below the kernel's own interrupt threads.
constexpr int kPriority = 40;

}  // namespace

std::string BecomeRealtime() {
  sched_param parameters{};
  parameters.sched_priority = kPriority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters); error != 0) {
    return fmt::format(
        "the control loop runs without real-time priority: {} (expected CAP_SYS_NICE, or an rtprio of {} in "
        "/etc/security/limits.conf)",
        std::strerror(error), kPriority);
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    return fmt::format(
        "the control loop's memory may be paged out: {} (expected CAP_IPC_LOCK, or memlock unlimited in "
        "/etc/security/limits.conf)",
        std::strerror(errno));
  }
  return {};
}

}  // namespace strainwave::bench
