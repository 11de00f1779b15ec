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

  /// In the place of one of the same identifier that still waits: of two values only the newer one is of use,
  /// and a stop that is asked for in the midst of a cycle does not double what the bus has to carry.
  [[nodiscard]] bool PushNewest(const CanFrame& frame) noexcept {
    for (std::size_t i = 0; i < size_; ++i) {
      CanFrame& waiting = frames_[(first_ + i) % Capacity];
      if (waiting.id != frame.id) continue;
      waiting = frame;
      return true;
    }
    return Push(frame);
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
