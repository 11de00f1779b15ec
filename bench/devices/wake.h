// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace strainwave::bench {

/// Calls a device's thread out of its waiting. What was called before it waits is not lost.
class Wake {
 public:
  /// @throws std::system_error when the system has no more descriptors.
  Wake();
  Wake(const Wake&) = delete;
  Wake& operator=(const Wake&) = delete;
  ~Wake();

  /// From any thread; returns at once.
  void Call() noexcept;
  /// Whether there was a call since the last time; forgets it.
  bool Take() noexcept;
  /// Until a call or the end of `longest`; the call is not taken.
  void Wait(std::chrono::nanoseconds longest) const noexcept;

  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// Waits until `descriptor` can be read (or is gone), `wake` was called (null: nobody calls), or `longest`
/// has passed.
enum class Waited { kReadable, kCalled, kTimeout };
Waited WaitReadable(int descriptor, const Wake* wake, std::chrono::nanoseconds longest) noexcept;

}  // namespace strainwave::bench
