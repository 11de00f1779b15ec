// SPDX-License-Identifier: Apache-2.0
#include "bench/serving/worker.h"

#include <utility>

namespace strainwave::bench {

Worker::Worker(std::size_t most_waiting, AtEnd at_end)
    : most_waiting_(most_waiting), at_end_(at_end), thread_([this] { Work(); }) {}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    if (at_end_ == AtEnd::kDrop) tasks_.clear();
  }
  changed_.notify_all();
  thread_.join();
}

bool Worker::Post(Task task) {
  {
    const std::lock_guard lock(mutex_);
    if (tasks_.size() >= most_waiting_) return false;
    tasks_.push_back(std::move(task));
  }
  changed_.notify_one();
  return true;
}

void Worker::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    const Task task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    task();
    lock.lock();
  }
}

}  // namespace strainwave::bench
