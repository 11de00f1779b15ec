// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace strainwave::bench {

/// Does what takes long for a server's thread, one task after the other, in a thread of its own.
class Worker {
 public:
  using Task = std::function<void()>;   // throws nothing
  enum class AtEnd { kFinish, kDrop };  // what becomes of tasks that still wait

  Worker(std::size_t most_waiting, AtEnd at_end);
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker();

  /// Returns at once. @return false where too many wait already; the task is then not taken.
  bool Post(Task task);

 private:
  void Work();

  const std::size_t most_waiting_;
  const AtEnd at_end_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> tasks_;
  bool stop_{};
  std::thread thread_;
};

}  // namespace strainwave::bench
