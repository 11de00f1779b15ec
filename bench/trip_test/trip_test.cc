// SPDX-License-Identifier: Apache-2.0
#include "bench/trip_test/trip_test.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "bench/seconds.h"
#include "bench/text.h"

namespace strainwave::bench {
namespace {

using std::chrono::nanoseconds;

constexpr double kForAPerson_s = 120.0;  // to do what was asked
// Beyond what is stated, so that a late trip is told with its time.
constexpr double kBeyondStated_s = 1.0;

std::string Milliseconds(double time_s) { return Text("{:.0f} ms", 1e3 * time_s); }

std::string Seen(const TripRow& row, const TripObservation& seen, const TripResult& result) {
  if (!seen.reason) return Text("not tripped within {}", Milliseconds(seen.waited_s));
  std::string words =
      result.tripped_after_s ? "tripped after " + Milliseconds(*result.tripped_after_s) : "tripped";
  const bool other = !IsAbout(row, seen.reason);
  if (other) words += " as " + result.stopped_as;
  if (result.safe_after_s) {
    words += ", safe after " + Milliseconds(*result.safe_after_s);
  } else {
    words += ", not safe within " + Milliseconds(row.safe_within_s + kBeyondStated_s);
  }
  if (other) words += ": " + Describe(seen.reason);
  return words;
}

// The shafts run out; a phase that was suspended has not waited for them.
void WaitUntilSafe(WatchedDevices& watched, double period_s, double at_most_s) {
  BenchClock& clock = watched.Devices().clock;
  const nanoseconds give_up = clock.Now() + Nanoseconds(at_most_s);
  while (!watched.times().safe_since && clock.Now() < give_up) {
    clock.SleepUntil(clock.Now() + Nanoseconds(period_s));
  }
}

TripObservation Trip(const TripRow& row, TripBench& bench, const TripSettings& settings,
                     const RunnerSettings& runner_settings, const std::atomic<StopRequest>& request) {
  TripObservation seen;
  seen.moment_is_known = bench.ProvokesItself(row);
  seen.waited_s = seen.moment_is_known ? row.noticed_within_s + kBeyondStated_s : kForAPerson_s;
  WatchedDevices watched(bench.Devices(), [&] { return bench.StandsSafe(); });
  PhaseRunner runner(watched.Devices(), runner_settings, request);
  const TripMotion motion = bench.MotionFor(row);
  ProvokedProgram program(MakeMotion(motion, settings, runner_settings.control_period_s), motion,
                          seen.waited_s, [&](const ProvokedState& state) {
                            bench.Provoke(row, state, runner);
                            watched.Provoked();
                          });
  seen.reason =
      runner.Run(program, [&](const PhaseSnapshot&, const PhaseProgram&) { bench.Beat(row); }).reason;
  WaitUntilSafe(watched, runner_settings.control_period_s, row.safe_within_s + kBeyondStated_s);
  seen.times = watched.times();
  seen.as_expected = bench.Accepts(row, seen.reason);
  seen.how_provoked = bench.HowProvoked(row);
  return seen;
}

}  // namespace

std::string_view Name(TripVerdict verdict) {
  switch (verdict) {
    case TripVerdict::kPassed:
      return "passed";
    case TripVerdict::kFailed:
      return "failed";
    case TripVerdict::kSkipped:
      return "skipped";
  }
  return "";
}

TripResult JudgeTrip(const TripRow& row, const TripObservation& seen) {
  TripResult result;
  result.verdict = TripVerdict::kFailed;
  const TripTimes& times = seen.times;
  if (seen.reason) {
    result.stopped_as = Code(seen.reason.cause);
    const auto from = seen.moment_is_known ? times.provoked : times.ordered;
    if (seen.moment_is_known && from && times.ordered) {
      result.tripped_after_s = Seconds(*times.ordered - *from);
    }
    // Safe before the order: the shafts stood all the time.
    if (from && times.safe_since) result.safe_after_s = std::max(0.0, Seconds(*times.safe_since - *from));
  }
  const bool tripped_in_time =
      !seen.moment_is_known || (result.tripped_after_s && *result.tripped_after_s <= row.noticed_within_s);
  const double safe_within_s =
      seen.moment_is_known ? row.safe_within_s : row.safe_within_s - row.noticed_within_s;
  const bool safe_in_time = result.safe_after_s && *result.safe_after_s <= safe_within_s;
  if (seen.as_expected && tripped_in_time && safe_in_time) result.verdict = TripVerdict::kPassed;
  result.seen = Seen(row, seen, result);
  if (!seen.how_provoked.empty()) result.seen += "; " + seen.how_provoked;
  return result;
}

std::vector<TripResult> RunTripTest(const std::vector<TripRow>& rows, TripBench& bench,
                                    const TripSettings& settings, const RunnerSettings& runner,
                                    const std::atomic<StopRequest>& request,
                                    const std::function<void(std::size_t)>& on_row) {
  std::vector<TripResult> results;
  bool stopped = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TripRow& row = rows[i];
    TripResult result;
    stopped = stopped || request.load() != StopRequest::kNone;
    if (stopped) {
      result.seen = "the test was stopped before";
    } else if (!row.unwatched.empty()) {
      result.seen = row.unwatched;
    } else {
      on_row(i);
      result.seen = bench.Prepare(row);
      if (result.seen.empty()) {
        const TripObservation seen = Trip(row, bench, settings, runner, request);
        bench.Finish(row);
        stopped = IsRequest(seen.reason.cause) && seen.reason.cause != row.cause;
        result = JudgeTrip(row, seen);
        if (stopped) result = {TripVerdict::kSkipped, {}, {}, result.stopped_as, "stopped on request"};
      }
    }
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace strainwave::bench
