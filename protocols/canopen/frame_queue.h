// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "protocols/can_frame.h"

namespace strainwave::protocols::canopen {

/// Frames on their way out, first in first out, in memory of its own.
template <std::size_t Capacity>
class FrameQueue {
 public:
  /// False when full: the frame is not kept.
  [[nodiscard]] bool Push(const CanFrame& frame) noexcept {
    if (size_ == Capacity) return false;
    frames_[(first_ + size_) % Capacity] = frame;
    ++size_;
    return true;
  }

  std::optional<CanFrame> Pop() noexcept {
    if (size_ == 0) return std::nullopt;
    const CanFrame frame = frames_[first_];
    first_ = (first_ + 1) % Capacity;
    --size_;
    return frame;
  }

  /// Forgets all of them, so that nothing commanded before a stop goes out after it.
  void Purge() noexcept { size_ = 0; }

 private:
  std::array<CanFrame, Capacity> frames_{};
  std::size_t first_{};
  std::size_t size_{};
};

}  // namespace strainwave::protocols::canopen
