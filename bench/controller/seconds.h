// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace strainwave::bench {

constexpr double Seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace strainwave::bench
