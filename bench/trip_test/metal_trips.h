// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "bench/configuration/bench_description.h"
#include "bench/roles/bench_machine.h"
#include "bench/trip_test/trip_bench.h"

namespace strainwave::bench {

/// How the condition of a row comes about on a bench of metal.
struct MetalWay {
  enum class Kind {
    kLowered,  // the limit is brought down to below what the bench reads in slow motion
    kAsked,    // a person does something
    kNot,
  };
  Kind kind{};
  std::string words;  // what the person is to do; why it is not tested
};

MetalWay WayOnMetal(const TripRow& row, const BenchDescription& bench);

/// For a row whose limit is lowered, what it is lowered to: half of what is read now, a temperature one
/// kelvin below. All other limits are infinite: `PhaseRunner::LowerLimits` leaves those as they are.
struct LoweredLimits {
  schedules::Limits limits;
  double trip_temperature_degC{};
};
LoweredLimits LoweredFor(const TripRow& row, const ProvokedState& state);

/// The person at a bench of metal.
struct TripPerson {
  /// Asks for something to be done. @return nothing where it was; else why not, in the person's words.
  std::function<std::optional<std::string>(const std::string& what)> ask;
  std::function<void(const std::string& what)> tell;  // without waiting
  std::function<void()> wait_until_ready;  // until nothing is left to be done by hand before a start
  std::function<bool()> given_up;
};

/// A bench of metal: nothing is brought about that is dangerous. Limits are lowered in slow motion, never
/// raised; what only a hand can do a person is asked for, and may skip with a reason. The drives themselves
/// tell what is true of the shafts.
class MetalTrips final : public TripBench {
 public:
  MetalTrips(BenchMachine& machine, const BenchDescription& bench, TripPerson person);

  std::string Prepare(const TripRow& row) override;
  BenchDevices Devices() override { return machine_.Devices(); }
  TripMotion MotionFor(const TripRow& row) const override;
  void Provoke(const TripRow& row, const ProvokedState& state, PhaseRunner& runner) noexcept override;
  bool ProvokesItself(const TripRow& row) const override;
  bool Accepts(const TripRow& row, const StopReason& reason) const override;
  std::string HowProvoked(const TripRow& row) const override;
  void Beat(const TripRow& row) override;
  bool StandsSafe() noexcept override;
  void Finish(const TripRow& row) override;

 private:
  BenchMachine& machine_;
  const BenchDescription& bench_;
  TripPerson person_;
  ProvokedState provoked_;  // what was read when the limit was lowered
  bool told_{};
};

}  // namespace strainwave::bench
