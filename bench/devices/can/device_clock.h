// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <time.h>

#include <algorithm>
#include <chrono>
#include <span>

namespace strainwave::bench {

/// Takes times of an interface's own clock to ours. What arrives has been on its way for an unknown time, at
/// the least for some: the smallest difference seen is the nearest to the truth, and is let grow with the
/// drift that two quartzes may have. A time never lies after its arrival. A jump of the device's clock is
/// followed.
class DeviceClock {
 public:
  /// @param arrival  on our clock, when the frame was taken from the kernel; never steps back.
  std::chrono::nanoseconds ToOurs(std::chrono::nanoseconds device,
                                  std::chrono::nanoseconds arrival) noexcept {
    constexpr std::chrono::nanoseconds kJump = std::chrono::seconds(1);
    const std::chrono::nanoseconds difference = arrival - device;
    if (!known_ || difference - difference_ > kJump) {
      difference_ = difference;
    } else {
      const std::chrono::nanoseconds drift = (arrival - last_) / kMostDriftDivisor;
      difference_ = std::min(difference_ + drift, difference);
    }
    known_ = true;
    last_ = arrival;
    return device + difference_;
  }

 private:
  static constexpr int kMostDriftDivisor = 5000;  // 200 ppm

  bool known_{};
  std::chrono::nanoseconds difference_{};
  std::chrono::nanoseconds last_{};
};

inline std::chrono::nanoseconds NanosecondsOf(const timespec& time) noexcept {
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

/// When a frame came in, on our clock: as the interface stamped it where it does, else as the kernel did,
/// unless the wall clock was set meanwhile.
/// @param stamps  as SO_TIMESTAMPING has them (Linux, Documentation/networking/timestamping.rst, 2.1): the
///   first is the kernel's on the wall clock, the third the interface's on its own; zero: none.
/// @param arrival, wall  now, on our clock and on the wall clock.
inline std::chrono::nanoseconds TimeOfFrame(std::span<const timespec, 3> stamps,
                                            std::chrono::nanoseconds arrival, std::chrono::nanoseconds wall,
                                            DeviceClock& clock) noexcept {
  const std::chrono::nanoseconds hardware = NanosecondsOf(stamps[2]);
  if (hardware.count() != 0) return clock.ToOurs(hardware, arrival);
  const std::chrono::nanoseconds age = wall - NanosecondsOf(stamps[0]);
  return age.count() >= 0 && age < std::chrono::seconds(1) ? arrival - age : arrival;
}

}  // namespace strainwave::bench
