// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace strainwave::bench {

/// Hands the newest value from one thread to one other, without a lock on either side: three slots, of which
/// the writer fills one, the reader holds one, and the third is passed between them. Values that the reader
/// was too slow for are gone, which is what newest means.
template <typename Value>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<Value>);

 public:
  explicit LatestValue(const Value& initial = {}) { slots_.fill(initial); }
  LatestValue(const LatestValue&) = delete;
  LatestValue& operator=(const LatestValue&) = delete;

  /// From the writing thread alone.
  void Write(const Value& value) noexcept {
    slots_[writing_] = value;
    writing_ =
        passed_.exchange(static_cast<std::uint8_t>(writing_ | kNew), std::memory_order_acq_rel) & kSlot;
  }

  /// From the reading thread alone: the newest value; the initial one before anything was written.
  const Value& Read() noexcept {
    if (passed_.load(std::memory_order_relaxed) & kNew) {
      reading_ = passed_.exchange(reading_, std::memory_order_acq_rel) & kSlot;
    }
    return slots_[reading_];
  }

 private:
  static constexpr std::uint8_t kSlot = 3;
  static constexpr std::uint8_t kNew = 4;

  std::array<Value, 3> slots_;
  std::uint8_t writing_{0};
  std::uint8_t reading_{1};
  std::atomic<std::uint8_t> passed_{2};
};

}  // namespace strainwave::bench
