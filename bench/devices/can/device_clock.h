// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

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

}  // namespace strainwave::bench
