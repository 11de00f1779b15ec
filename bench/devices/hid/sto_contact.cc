// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/hid/sto_contact.h"

#include <utility>

namespace strainwave::bench {

using std::chrono::nanoseconds;

StoContact::StoContact(const HidSettings& settings, const protocols::HidField& contact,
                       const BenchClock& clock)
    : contact_(contact), device_(settings, clock, *this) {}

void StoContact::Asked(nanoseconds time) noexcept {
  std::int64_t nobody = kNobody;
  asked_ns_.compare_exchange_strong(nobody, time.count());
}

void StoContact::Report(std::span<const std::uint8_t> report, nanoseconds time) {
  const protocols::HidValue value = TakeField(contact_, report);
  const bool good = value.problem == protocols::HidProblem::kNone;
  const bool open = !good || value.value == 0;
  const StoActual before = actual_.Get();
  actual_.Set({open, good, time});
  if (!good || !open || (before.good && before.open)) return;
  const std::int64_t asked_ns = asked_ns_.exchange(kNobody);
  StoOpening opening{time, std::nullopt};
  if (asked_ns != kNobody) opening.latency = time - nanoseconds(asked_ns);
  const std::lock_guard lock(mutex_);
  openings_.push_back(opening);
}

std::vector<StoOpening> StoContact::TakeOpenings() {
  const std::lock_guard lock(mutex_);
  return std::exchange(openings_, {});
}

}  // namespace strainwave::bench
