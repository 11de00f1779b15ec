// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace strainwave::daq::acquisition {

/// A ring of slots between one thread that writes and one that reads, without locks. All memory is taken when
/// it is made. A writer that finds it full is told so, and counted; nothing that was not read is overwritten.
template <typename Slot>
class SpscRing {
 public:
  /// `slots` copies of `empty`. @throws std::invalid_argument if there is none.
  SpscRing(std::size_t slots, const Slot& empty) : slots_(slots, empty) {
    if (slots == 0) throw std::invalid_argument("slots = 0 is not above zero");
  }
  SpscRing(const SpscRing&) = delete;
  SpscRing& operator=(const SpscRing&) = delete;

  std::size_t slots() const { return slots_.size(); }

  /// Writer: the slot to fill, or nullptr if all are unread, which counts as one overrun.
  Slot* BeginWrite() noexcept {
    const std::uint64_t written = written_.load(std::memory_order_relaxed);
    if (written - read_seen_ == slots_.size()) {
      // The reader's counter is fetched only when the last look at it says "full".
      read_seen_ = read_.load(std::memory_order_acquire);
      if (written - read_seen_ == slots_.size()) {
        overruns_.fetch_add(1, std::memory_order_relaxed);
        return nullptr;
      }
    }
    return &slots_[written % slots_.size()];
  }
  /// Writer: hands over the slot that `BeginWrite()` gave.
  void EndWrite() noexcept {
    written_.store(written_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Reader: the oldest slot that is unread, or nullptr.
  Slot* BeginRead() noexcept {
    const std::uint64_t read = read_.load(std::memory_order_relaxed);
    if (written_seen_ == read) {
      written_seen_ = written_.load(std::memory_order_acquire);
      if (written_seen_ == read) return nullptr;
    }
    return &slots_[read % slots_.size()];
  }
  /// Reader: gives back the slot that `BeginRead()` gave.
  void EndRead() noexcept {
    read_.store(read_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Any thread: how often the writer found no room.
  std::uint64_t overruns() const noexcept { return overruns_.load(std::memory_order_relaxed); }
  /// Any thread: slots written and not yet read; a moment later it may be another number.
  std::size_t unread() const noexcept {
    const std::uint64_t read = read_.load(std::memory_order_acquire);
    return static_cast<std::size_t>(written_.load(std::memory_order_acquire) - read);
  }

 private:
  // Each side's counters have a cache line of their own, so that one does not slow the other down.
  static constexpr std::size_t kCacheLine_bytes = 64;

  std::vector<Slot> slots_;
  alignas(kCacheLine_bytes) std::atomic<std::uint64_t> written_{0};
  std::uint64_t read_seen_{0};  // the writer's
  std::atomic<std::uint64_t> overruns_{0};
  alignas(kCacheLine_bytes) std::atomic<std::uint64_t> read_{0};
  std::uint64_t written_seen_{0};  // the reader's
};

}  // namespace strainwave::daq::acquisition
