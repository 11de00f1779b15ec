// SPDX-License-Identifier: Apache-2.0
// Preloaded: the monotonic clock goes faster (STRAINWAVE_QUICK_CLOCK times), so that what a run does every
// ten seconds is done in one that takes less than a second.
#include <dlfcn.h>
#include <pthread.h>

#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

using ReadClock = int (*)(clockid_t, timespec*);
using WaitUntil = int (*)(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*);

std::int64_t NanosecondsOf(const timespec& time) { return time.tv_sec * kSecond_ns + time.tv_nsec; }
timespec TimeOf(std::int64_t time_ns) { return {time_ns / kSecond_ns, time_ns % kSecond_ns}; }

int ReadReal(clockid_t clock, timespec* time) {
  static const auto read = reinterpret_cast<ReadClock>(::dlsym(RTLD_NEXT, "clock_gettime"));
  return read(clock, time);
}

std::int64_t Start_ns() {
  static const std::int64_t start_ns = [] {
    timespec now{};
    ReadReal(CLOCK_MONOTONIC, &now);
    return NanosecondsOf(now);
  }();
  return start_ns;
}

std::int64_t Factor() {
  static const std::int64_t factor = [] {
    const char* const text = std::getenv("STRAINWAVE_QUICK_CLOCK");
    return text == nullptr ? 1 : std::strtoll(text, nullptr, 10);
  }();
  return factor;
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) {
  const std::int64_t start_ns = Start_ns();
  const int code = ReadReal(clock, time);
  if (code == 0 && clock == CLOCK_MONOTONIC)
    *time = TimeOf(start_ns + (NanosecondsOf(*time) - start_ns) * Factor());
  return code;
}

// Whoever waits means the clock that goes faster.
extern "C" int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                                      const timespec* until) {
  static const auto wait = reinterpret_cast<WaitUntil>(::dlsym(RTLD_NEXT, "pthread_cond_clockwait"));
  if (clock != CLOCK_MONOTONIC) return wait(condition, mutex, clock, until);
  const std::int64_t start_ns = Start_ns();
  const timespec real = TimeOf(start_ns + (NanosecondsOf(*until) - start_ns) / Factor());
  return wait(condition, mutex, clock, &real);
}
