// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace strainwave::bench {

/// The newest value that one thread has for others. Neither side ever waits: a reader looks again only when
/// the writer has gone three values on meanwhile, never for a writer that was interrupted half way.
template <typename Value>
class Latest {
  static_assert(std::is_trivially_copyable_v<Value> && std::is_default_constructible_v<Value>);

 public:
  Latest() { Set(Value{}); }
  Latest(const Latest&) = delete;
  Latest& operator=(const Latest&) = delete;

  /// From one thread only.
  void Set(const Value& value) noexcept {
    const std::uint64_t next = newest_.load(std::memory_order_relaxed) + 1;
    Words words{};
    std::memcpy(words.data(), &value, sizeof(Value));
    // Whoever sees a word of this value must see that the slot was taken.
    taken_.store(next, std::memory_order_relaxed);
    Slot& slot = slots_[next % kSlots];
    for (std::size_t i = 0; i < kWords; ++i) slot[i].store(words[i], std::memory_order_release);
    newest_.store(next, std::memory_order_release);
  }

  Value Get() const noexcept {
    for (;;) {
      const std::uint64_t number = newest_.load(std::memory_order_acquire);
      const Slot& slot = slots_[number % kSlots];
      Words words;
      for (std::size_t i = 0; i < kWords; ++i) words[i] = slot[i].load(std::memory_order_acquire);
      if (taken_.load(std::memory_order_relaxed) - number >= kSlots) continue;
      Value value;
      std::memcpy(static_cast<void*>(&value), words.data(), sizeof(Value));
      return value;
    }
  }

 private:
  static constexpr std::size_t kSlots = 4;
  static constexpr std::size_t kWords = (sizeof(Value) + 7) / 8;
  using Words = std::array<std::uint64_t, kWords>;
  using Slot = std::array<std::atomic<std::uint64_t>, kWords>;

  std::array<Slot, kSlots> slots_{};
  std::atomic<std::uint64_t> taken_{0};   // number of the value whose slot was last begun
  std::atomic<std::uint64_t> newest_{0};  // number of the last whole value
};

}  // namespace strainwave::bench
