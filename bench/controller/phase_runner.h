// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "bench/controller/live_extremes.h"
#include "bench/controller/phase_program.h"
#include "bench/safety/drive_watch.h"
#include "bench/safety/interlocks.h"
#include "bench/safety/shaft_watch.h"
#include "daq/acquisition/spsc_ring.h"
#include "daq/history_ring.h"

namespace strainwave::bench {

/// What a person has asked for; set from a signal handler, read by the control loop.
enum class StopRequest : int { kNone, kFinishCycle, kPause, kShutdown, kQuickStop };

/// The cause that ends a phase on this request; none for a request that only the end of the cycle answers.
StopCause CauseOf(StopRequest request);

/// How a phase ended, and everything that is known of why.
struct PhaseOutcome {
  StopReason reason;                 // none: the phase is complete
  std::string words{};               // what the reason alone does not say
  std::vector<StopReason> followed;  // other limits broken within a second after the first
  double credited_load_s{};
  std::vector<NamedRecord> records;
  /// Samples of all slow channels at the control rate, ten seconds before the stop and one after; only when
  /// the reason is a fault.
  std::vector<NamedRecord> black_box;
};

/// What a running phase says of itself.
struct PhaseSnapshot {
  double share_done{};
  double credited_load_s{};
  Readings readings;
};

/// Called about once a second of bench time. It may take its time and may throw; of the program it may ask
/// `RecordsSoFar` alone.
using HeartbeatFunction = std::function<void(const PhaseSnapshot&, const PhaseProgram&)>;

struct RunnerSettings {
  double control_period_s{0.01};
  double stale_after_s{0.03};  // how old readings may become
  schedules::Limits limits;
  schedules::SuspendRule suspend;
  /// The loop runs on a thread of its own, with real-time priority where the machine grants it, so that
  /// neither a disk nor a terminal holds it up; heartbeats come on the caller's. A simulated bench, whose
  /// clock waits for everybody, needs none, and gives the same bits every time without.
  bool own_thread{};
  double input_encoder_step_rad{};
};

/// Runs phases on the bench: keeps the period, watches every limit and every request, steps the program, and
/// leaves the bench with torque off and brakes on, however the phase ends.
class PhaseRunner {
 public:
  PhaseRunner(BenchDevices devices, const RunnerSettings& settings, const std::atomic<StopRequest>& request);

  /// @param heartbeat  may throw; the bench is safe before the exception leaves.
  PhaseOutcome Run(PhaseProgram& program, const HeartbeatFunction& heartbeat);

  /// Stands still with torque off until the suspend condition has been clear for its dwell.
  /// @return none, or why it ended without (a fault, a request, or suspended for too long).
  StopReason WaitUntilRecovered(const HeartbeatFunction& heartbeat);

  /// Torque off and brakes on, at once.
  void MakeSafe() noexcept;

  /// For a trip test, from the phase's own `Step`: limits that are lower than those in force, from the next
  /// period on until the runner is gone. None is ever raised.
  void LowerLimits(const schedules::Limits& limits, double trip_temperature_degC) noexcept {
    interlocks_.Lower(limits);
    suspend_.LowerTrip(trip_temperature_degC);
  }

  /// From now on every phase and every wait ends as a shutdown ends it, for the campaign's disk fills. From
  /// any thread, a heartbeat for one.
  void EndForFullDisk() noexcept { disk_full_.store(true, std::memory_order_relaxed); }

  /// Of the loop's last period; not while a phase runs.
  const Readings& last_readings() const noexcept { return readings_; }

  /// Of all readings since the last call, up to the last heartbeat or the end of the phase: none is left out,
  /// however late the call is. From the thread that runs phases, in a heartbeat or between phases.
  LiveExtremes TakeExtremes() noexcept;

  /// What the machine refused to the loop's own thread, in words; nothing when it has all it needs, or has no
  /// thread of its own.
  const std::string& realtime_trouble() const noexcept { return realtime_trouble_; }

 private:
  using Beat = std::function<void(const PhaseSnapshot&)>;

  StopReason Loop(PhaseProgram& program, const Beat& beat);
  StopReason LoopOnItsOwnThread(PhaseProgram& program, const HeartbeatFunction& heartbeat);
  StopReason OnePeriod(PhaseProgram& program, double elapsed_s, double period_s) noexcept;
  StopReason SoftRequest() const noexcept;  // pause, shutdown or a full disk, where asked for
  InterlockInputs Inputs(const PhaseProgram& program) const noexcept;
  void AddToHistory(const Readings& readings) noexcept;
  void HandOverExtremes() noexcept;
  void AfterFault(PhaseProgram& program, PhaseOutcome& outcome);

  DriveWatch driving_;
  DriveWatch load_;
  BenchDevices devices_;  // with the drives as they are watched
  RunnerSettings settings_;
  Interlocks interlocks_;
  SuspendMonitor suspend_;
  ShaftWatch shaft_;
  const std::atomic<StopRequest>& request_;
  daq::HistoryRing history_;
  Readings readings_;
  LiveExtremes extremes_;                                 // since they were handed over
  daq::acquisition::SpscRing<LiveExtremes> handed_over_;  // by the loop, to whoever runs phases
  LiveExtremes waiting_extremes_;                         // of a phase that has ended
  std::atomic<bool> disk_full_{};
  std::atomic<bool> abandoned_{};  // a heartbeat has failed: the phase ends at once
  std::string realtime_trouble_;
};

}  // namespace strainwave::bench
