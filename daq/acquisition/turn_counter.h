// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace strainwave::daq::acquisition {

/// Counts on over any number of turns where a multi-turn encoder goes over at 32 bits: 2048 turns either way
/// of one with 20 bits a turn.
class TurnCounter {
 public:
  TurnCounter() = default;
  /// Goes on from what was counted before the power went.
  explicit TurnCounter(std::int64_t counted) noexcept : counted_(counted) {}

  /// @param counts  as sent; less than 2^31 away from those before, whichever way round is shorter.
  /// @return the same without the leaps; those of the first call are taken as they are.
  std::int64_t Follow(std::int32_t counts) noexcept {
    counted_ +=
        static_cast<std::int32_t>(static_cast<std::uint32_t>(counts) - static_cast<std::uint32_t>(counted_));
    return counted_;
  }
  std::int64_t counted() const noexcept { return counted_; }

 private:
  std::int64_t counted_{};
};

}  // namespace strainwave::daq::acquisition
