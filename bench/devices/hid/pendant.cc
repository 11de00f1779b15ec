// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/hid/pendant.h"

namespace strainwave::bench {

using protocols::HidProblem;
using std::chrono::nanoseconds;

Pendant::Pendant(const PendantProfile& profile, const BenchClock& clock)
    : profile_(profile), clock_(clock), device_(profile.device, clock, *this) {}

void Pendant::Take(const PendantKeys& keys, nanoseconds time) {
  const PendantState next = NextPendantState(mine_.state, mine_.keys, keys);
  if (next == PendantState::kStopped && mine_.state != next) mine_.stop_time = time;
  mine_.state = next;
  mine_.keys = keys;
  mine_.time = time;
  actual_.Set(mine_);
}

void Pendant::Plugged(nanoseconds time) {
  mine_.connected = true;
  Take({}, time);
}

void Pendant::Unplugged(nanoseconds time) {
  mine_.connected = false;
  Take({}, time);
}

void Pendant::Report(std::span<const std::uint8_t> report, nanoseconds time) {
  const protocols::HidValue stop = TakeField(profile_.quick_stop, report);
  const protocols::HidValue reset = TakeField(profile_.reset, report);
  const protocols::HidValue start = TakeField(profile_.start, report);
  for (const protocols::HidValue& value : {stop, reset, start}) {
    if (value.problem == HidProblem::kNone) continue;
    ++mine_.refused_reports;
    Take({}, time);
    return;
  }
  // A pendant that was silent for too long was pressed meanwhile.
  if (profile_.report_period.count() != 0 && time - mine_.time > profile_.report_period) Take({}, time);
  Take({stop.value != 0, reset.value != 0, start.value != 0}, time);
}

PendantActual Pendant::Actual() const noexcept {
  PendantActual actual = actual_.Get();
  if (profile_.report_period.count() != 0 && clock_.Now() - actual.time > profile_.report_period) {
    actual.state = PendantState::kStopped;
    actual.keys = {};
  }
  return actual;
}

}  // namespace strainwave::bench
