// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pthread.h>

namespace strainwave::bench {

/// A mutex that a real-time thread shares with ordinary ones, for std::lock_guard: who holds it runs at the
/// priority of who waits for it. Behind a std::mutex the real-time thread waits until the ordinary one gets
/// the processor again, which on a busy machine takes tens of milliseconds.
class RealtimeMutex {
 public:
  RealtimeMutex() noexcept {
    pthread_mutexattr_t attributes;
    pthread_mutexattr_init(&attributes);
    pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    pthread_mutex_init(&mutex_, &attributes);
    pthread_mutexattr_destroy(&attributes);
  }
  RealtimeMutex(const RealtimeMutex&) = delete;
  RealtimeMutex& operator=(const RealtimeMutex&) = delete;
  ~RealtimeMutex() { pthread_mutex_destroy(&mutex_); }

  void lock() noexcept { pthread_mutex_lock(&mutex_); }
  void unlock() noexcept { pthread_mutex_unlock(&mutex_); }

 private:
  pthread_mutex_t mutex_{};
};

}  // namespace strainwave::bench
