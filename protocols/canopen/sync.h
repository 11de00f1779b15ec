// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "protocols/can_frame.h"

namespace strainwave::protocols::canopen {

/// SYNC (CiA 301, 7.2.5): without data, or with a counter that runs from 1 to `overflow` (1019h, 2 to 240).
class SyncProducer {
 public:
  SyncProducer() = default;
  /// @throws std::invalid_argument if overflow is not 0 (no counter) or 2 to 240.
  explicit SyncProducer(std::uint8_t overflow);

  CanFrame Next() noexcept;

 private:
  std::uint8_t overflow_{};
  std::uint8_t counter_{};
};

/// Intervals between SYNCs, as they were.
struct SyncIntervals {
  std::uint64_t count{};
  std::chrono::nanoseconds min{};
  std::chrono::nanoseconds max{};
  std::chrono::nanoseconds mean{};
};

class SyncMeter {
 public:
  /// The interval since the SYNC before; nothing for the first.
  std::optional<std::chrono::nanoseconds> OnSync(std::chrono::nanoseconds now) noexcept;

  /// Of the intervals since the last `Take`; of none all zero.
  SyncIntervals intervals() const noexcept;
  /// The same, and begins anew.
  SyncIntervals Take() noexcept;

 private:
  std::optional<std::chrono::nanoseconds> last_;
  std::uint64_t count_{};
  std::chrono::nanoseconds min_{};
  std::chrono::nanoseconds max_{};
  std::chrono::nanoseconds sum_{};
};

}  // namespace strainwave::protocols::canopen
