// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "bench/configuration/bench_description.h"
#include "bench/devices/simulated/simulated_bench.h"
#include "bench/machines/simulated_machine.h"
#include "bench/trip_test/trip_bench.h"

namespace strainwave::bench {

/// The fault of the simulated bench that breaks this interlock within a control period.
Injection InjectionFor(const TripRow& row, const TripSettings& settings);

/// A simulated bench: conditions are its own injected faults, and what is true of the shafts is told by the
/// simulated mechanics. Every row has a bench of its own, cold and at rest.
class SimulatedTrips : public TripBench {
 public:
  /// @throws BenchFileError for a plant term or a parameter that there is not.
  SimulatedTrips(const BenchDescription& bench, const TripSettings& settings);

  std::string Prepare(const TripRow& row) override;
  BenchDevices Devices() override;
  TripMotion MotionFor(const TripRow& row) const override;
  void Provoke(const TripRow& row, const ProvokedState& state, PhaseRunner& runner) noexcept override;
  bool ProvokesItself(const TripRow&) const override { return true; }
  bool StandsSafe() noexcept override;

 private:
  BenchDescription bench_;
  TripSettings settings_;
  std::unique_ptr<SimulatedMachine> machine_;
};

}  // namespace strainwave::bench
