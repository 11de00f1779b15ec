// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "bench/devices/canopen/drive_bus.h"
#include "bench/devices/wake.h"
#include "bench/realtime/timing_histogram.h"
#include "bench/roles/bench_clock.h"

namespace strainwave::bench {

/// Runs a drive bus on a thread of its own, from the start to the end of the program, so that the drives hear
/// their master also while nobody moves them. The end is a stop: drives are given the time to come to rest.
class DriveBusThread {
 public:
  /// @param clock  of the control loop; only asked for the time.
  DriveBusThread(DriveBus& bus, const BenchClock& clock);
  DriveBusThread(const DriveBusThread&) = delete;
  DriveBusThread& operator=(const DriveBusThread&) = delete;
  ~DriveBusThread();

  /// What is done about a fault that a drive still has from before.
  enum class Faults { kKeep, kReset };

  /// Sets up every drive anew and waits for it.
  /// @return nothing when all are ready; else what went wrong, drive by drive, in words.
  std::string Commission(std::chrono::nanoseconds patience, Faults faults = Faults::kKeep);

  struct Timing {
    TimingHistogram periods;   // between two cycles
    TimingHistogram lateness;  // of a cycle against its time
    std::string trouble;       // what of real time was refused, in words
  };
  /// After the thread has ended.
  const Timing& timing() const noexcept { return timing_; }
  void End() noexcept;

 private:
  void Run() noexcept;
  bool AtRest() const noexcept;

  DriveBus& bus_;
  const BenchClock& clock_;
  Wake wake_;
  std::atomic<bool> ending_{};
  Timing timing_;
  std::thread thread_;
};

}  // namespace strainwave::bench
