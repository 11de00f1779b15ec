// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/controller/phase_runner.h"
#include "bench/trip_test/trip_bench.h"
#include "bench/trip_test/trip_row.h"
#include "bench/trip_test/watched_devices.h"

namespace strainwave::bench {

enum class TripVerdict { kPassed, kFailed, kSkipped };

/// "passed", "failed", "skipped".
std::string_view Name(TripVerdict verdict);

/// What was seen of one row.
struct TripResult {
  TripVerdict verdict{TripVerdict::kSkipped};
  std::optional<double> tripped_after_s;  // the order to stop; nothing where a person chose the moment
  std::optional<double> safe_after_s;     // the shafts; after the order where a person chose the moment
  std::string stopped_as;                 // code of what stopped it; empty: nothing did
  std::string seen;                       // all of it in words; why a row was skipped
};

/// How a row went.
struct TripObservation {
  StopReason reason;  // none: nothing stopped it
  TripTimes times;
  double waited_s{};           // for the trip, at most
  bool as_expected{};          // it is what the row is about
  bool moment_is_known{true};  // of the condition
  std::string how_provoked{};  // what the row does not say of it
};

/// Passed: stopped by what the row is about, in time, and the shafts stand safe in time, by what is true of
/// them.
TripResult JudgeTrip(const TripRow& row, const TripObservation& seen);

/// Every row in turn. Each ends with torque off and brakes on, whatever it found; so does an exception. A
/// stop that a person asks for ends the test, and the rows that are left say so.
/// @param on_row  called before each, with its index.
std::vector<TripResult> RunTripTest(const std::vector<TripRow>& rows, TripBench& bench,
                                    const TripSettings& settings, const RunnerSettings& runner,
                                    const std::atomic<StopRequest>& request,
                                    const std::function<void(std::size_t)>& on_row);

}  // namespace strainwave::bench
