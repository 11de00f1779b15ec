// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/controller/phase_runner.h"
#include "bench/roles/bench_devices.h"
#include "bench/trip_test/provoked_program.h"
#include "bench/trip_test/trip_row.h"

namespace strainwave::bench {

/// A bench on which interlocks are tripped, one after the other.
class TripBench {
 public:
  TripBench() = default;
  TripBench(const TripBench&) = delete;
  TripBench& operator=(const TripBench&) = delete;
  virtual ~TripBench() = default;

  /// Before a row: what an earlier one has left behind is gone, and a person who is needed was asked.
  /// @return why the row is skipped; empty: it is tested.
  virtual std::string Prepare(const TripRow& row) = 0;

  /// Of the row that was prepared last.
  virtual BenchDevices Devices() = 0;

  virtual TripMotion MotionFor(const TripRow& row) const = 0;

  /// Brings the condition about, or leaves that to a person. From the control loop, at a period's end.
  virtual void Provoke(const TripRow& row, const ProvokedState& state, PhaseRunner& runner) noexcept = 0;

  /// Whether the condition is there from `Provoke` on; else a person brings it about some time later, and the
  /// time to the trip is not known.
  virtual bool ProvokesItself(const TripRow& row) const = 0;

  /// Whether this stop is what the row is about.
  virtual bool Accepts(const TripRow& row, const StopReason& reason) const { return IsAbout(row, reason); }

  /// What the condition was, where the row itself does not say it; after `Provoke`.
  virtual std::string HowProvoked(const TripRow&) const { return {}; }

  /// About once a second while the row is tested; not from the control loop.
  virtual void Beat(const TripRow&) {}

  /// No torque, brakes on, and the shafts stand, by another way than the interlocks. From the control loop.
  virtual bool StandsSafe() noexcept = 0;

  /// After a row, with the shafts at rest.
  virtual void Finish(const TripRow&) {}
};

}  // namespace strainwave::bench
