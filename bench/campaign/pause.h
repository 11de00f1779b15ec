// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace strainwave::bench {

/// The present on two clocks of this machine.
struct Moment {
  std::int64_t utc_ms{};         // can be set by anybody
  std::int64_t since_boot_ms{};  // CLOCK_BOOTTIME: cannot be set, runs on in standby, ends with the boot
  std::uint64_t boot{};          // first half of the boot's id; 0: not known
};
Moment Now();

/// How long a campaign has stood.
struct Pause {
  std::optional<double> length_s;  // nothing: not known, and to be taken for longer than any
  std::string clock;               // by which it was measured, or why by none
};

/// Within one boot by the clock of the boot, whatever has become of UTC; else by UTC, unless that cannot be:
/// below zero, shorter than the machine has been up since, or years.
Pause PauseBetween(const Moment& then, const Moment& now);

}  // namespace strainwave::bench
