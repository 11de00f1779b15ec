// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace strainwave::bench {

/// Calls task(0) … task(count − 1) on all processors, this thread among them, and comes back when all are
/// done. After an exception no further task is begun; the first one is thrown again here. A task may call it
/// in turn.
void OnAllProcessors(std::size_t count, const std::function<void(std::size_t)>& task);

/// While it lives, `OnAllProcessors` uses at most so many threads, which are made here, so that none is
/// missing later: for a program that locks its memory, the stack of each of them too
/// (bench/realtime/realtime.h).
class ProcessorLimit {
 public:
  /// @throws std::system_error when the machine refuses another thread; std::bad_alloc.
  explicit ProcessorLimit(std::size_t most);
  ProcessorLimit(const ProcessorLimit&) = delete;
  ProcessorLimit& operator=(const ProcessorLimit&) = delete;
  ~ProcessorLimit();

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

}  // namespace strainwave::bench
