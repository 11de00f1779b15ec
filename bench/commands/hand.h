// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <atomic>
#include <functional>
#include <thread>

#include "bench/controller/dead_man.h"
#include "bench/roles/bench_clock.h"

namespace strainwave::bench {

/// The hand on a terminal's keyboard: space and Enter hold, as long as the key repeats; any other key lets
/// go; q and the end of the input end it. Input that is no terminal is taken in the same way, byte for byte.
class Hand {
 public:
  /// @param ended  called once, from the hand's thread.
  Hand(DeadMan& dead_man, const BenchClock& clock, std::function<void()> ended);
  Hand(const Hand&) = delete;
  Hand& operator=(const Hand&) = delete;
  ~Hand();

 private:
  void Listen();

  DeadMan& dead_man_;
  const BenchClock& clock_;
  std::function<void()> ended_;
  bool is_terminal_;
  termios before_{};
  std::atomic<bool> stop_{};
  std::thread thread_;
};

}  // namespace strainwave::bench
