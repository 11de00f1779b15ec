// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/wake.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>

namespace strainwave::bench {
namespace {

timespec TimespecOf(std::chrono::nanoseconds time) {
  const auto longest = std::max(time, std::chrono::nanoseconds::zero());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(longest);
  return {seconds.count(), (longest - seconds).count()};
}

}  // namespace

Wake::Wake() : descriptor_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

Wake::~Wake() { ::close(descriptor_); }

void Wake::Call() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(descriptor_, &one, sizeof(one));  // full: called already
}

bool Wake::Take() noexcept {
  std::uint64_t calls = 0;
  return ::read(descriptor_, &calls, sizeof(calls)) == sizeof(calls);
}

void Wake::Wait(std::chrono::nanoseconds longest) const noexcept { WaitReadable(-1, this, longest); }

Waited WaitReadable(int descriptor, const Wake* wake, std::chrono::nanoseconds longest) noexcept {
  pollfd waited[] = {{descriptor, POLLIN, 0}, {wake != nullptr ? wake->descriptor() : -1, POLLIN, 0}};
  const timespec time = TimespecOf(longest);
  if (::ppoll(waited, 2, &time, nullptr) <= 0) return Waited::kTimeout;
  return waited[1].revents != 0 ? Waited::kCalled : Waited::kReadable;
}

}  // namespace strainwave::bench
