// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/pause.h"

#include <cmath>
#include <ctime>
#include <fstream>

#include <fmt/core.h>

#include "bench/campaign/folder.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

// A machine without a battery begins at 1970, a wrong year is typed in: no bench stands for longer and goes
// on.
constexpr double kLongestPossible_s = 10.0 * 365.25 * 86400.0;
// Between two clocks of one machine: UTC is slewed by up to 500 ppm while it is brought to a time server's.
constexpr double kSlewShare = 1e-3;
constexpr double kSlew_s = 1.0;

std::uint64_t BootId() {
  std::string text;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> text;
  std::erase(text, '-');
  if (text.size() < 16) return 0;
  return std::stoull(text.substr(0, 16), nullptr, 16);
}

Pause ByUtc(double utc_s, const Moment& then, const Moment& now) {
  if (utc_s < 0.0) {
    return {std::nullopt, fmt::format("UTC of this machine was set back, it says {:.1f} s", utc_s)};
  }
  if (utc_s > kLongestPossible_s) {
    return {std::nullopt, fmt::format("UTC of this machine was set ahead, it says {:.0f} years",
                                      utc_s / (365.25 * 86400.0))};
  }
  const double up_s = static_cast<double>(now.since_boot_ms) * 1e-3;
  if (then.boot != 0 && now.boot != 0 && utc_s + kSlewShare * up_s + kSlew_s < up_s) {
    return {std::nullopt,
            fmt::format("UTC of this machine was set back, it says {:.1f} s, but the machine was started "
                        "{:.1f} s ago and the campaign stood before that",
                        utc_s, up_s)};
  }
  return {utc_s, "UTC of this machine"};
}

}  // namespace

Moment Now() {
  static const std::uint64_t boot_id = BootId();
  std::timespec boot{};
  ::clock_gettime(CLOCK_BOOTTIME, &boot);
  return {UtcMilliseconds(), boot.tv_sec * 1000 + boot.tv_nsec / 1'000'000, boot_id};
}

Pause PauseBetween(const Moment& then, const Moment& now) {
  const double utc_s = static_cast<double>(now.utc_ms - then.utc_ms) * 1e-3;
  const double boot_s = static_cast<double>(now.since_boot_ms - then.since_boot_ms) * 1e-3;
  if (then.boot == 0 || then.boot != now.boot) return ByUtc(utc_s, then, now);
  if (boot_s < 0.0) {
    return {
        std::nullopt,
        fmt::format("the clock of this boot went back by {:.1f} s, as in a machine brought back from a copy",
                    -boot_s)};
  }
  const double set_s = utc_s - boot_s;
  if (std::abs(set_s) <= kSlewShare * boot_s + kSlew_s)
    return {boot_s, "clock of this machine since its start"};
  return {boot_s,
          fmt::format("clock of this machine since its start; UTC was set by {:+.1f} s meanwhile", set_s)};
}

}  // namespace strainwave::bench
