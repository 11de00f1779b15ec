// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cmath>

namespace strainwave::bench {

constexpr double Seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

inline std::chrono::nanoseconds Nanoseconds(double time_s) {
  return std::chrono::nanoseconds(std::llround(time_s * 1e9));
}

}  // namespace strainwave::bench
