// SPDX-License-Identifier: Apache-2.0
// Preloaded: the time of day is off by so many nanoseconds as a file says, which may change while the program
// runs. The clocks that nobody can set go as ever.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

using ReadClock = int (*)(clockid_t, timespec*);

// STRAINWAVE_SET_CLOCK: a file of eight bytes.
const volatile std::int64_t& Offset_ns() {
  static const std::int64_t none = 0;
  static const volatile std::int64_t* const offset_ns = [] {
    const char* const path = std::getenv("STRAINWAVE_SET_CLOCK");
    const int file = path == nullptr ? -1 : ::open(path, O_RDONLY | O_CLOEXEC);
    void* const mapped =
        file < 0 ? MAP_FAILED : ::mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
    if (file >= 0) ::close(file);
    return mapped == MAP_FAILED ? &none : static_cast<const std::int64_t*>(mapped);
  }();
  return *offset_ns;
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) {
  static const auto read = reinterpret_cast<ReadClock>(::dlsym(RTLD_NEXT, "clock_gettime"));
  const int code = read(clock, time);
  if (code != 0 || (clock != CLOCK_REALTIME && clock != CLOCK_REALTIME_COARSE)) return code;
  const std::int64_t now_ns = time->tv_sec * kSecond_ns + time->tv_nsec + Offset_ns();
  *time = {now_ns / kSecond_ns, now_ns % kSecond_ns};
  return 0;
}

extern "C" int gettimeofday(timeval* time, void*) {
  timespec now{};
  if (clock_gettime(CLOCK_REALTIME, &now) == 0) {
    *time = {now.tv_sec, now.tv_nsec / 1000};
  }
  return 0;
}

extern "C" std::time_t time(std::time_t* time) {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  if (time != nullptr) *time = now.tv_sec;
  return now.tv_sec;
}
