// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/sync.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "protocols/canopen/wire_bytes.h"

namespace strainwave::protocols::canopen {

using std::chrono::nanoseconds;

SyncProducer::SyncProducer(std::uint8_t overflow) : overflow_(overflow) {
  if (overflow == 1 || overflow > 240) {
    throw std::invalid_argument(fmt::format("overflow = {} is neither 0 nor 2 to 240", overflow));
  }
}

CanFrame SyncProducer::Next() noexcept {
  constexpr std::uint32_t kSyncId = 0x80;
  if (overflow_ == 0) return FrameOf(kSyncId, {});
  counter_ = counter_ >= overflow_ ? std::uint8_t{1} : static_cast<std::uint8_t>(counter_ + 1);
  return FrameOf(kSyncId, {counter_});
}

std::optional<nanoseconds> SyncMeter::OnSync(nanoseconds now) noexcept {
  if (!last_) {
    last_ = now;
    return std::nullopt;
  }
  const nanoseconds interval = now - *last_;
  last_ = now;
  min_ = count_ == 0 ? interval : std::min(min_, interval);
  max_ = count_ == 0 ? interval : std::max(max_, interval);
  sum_ += interval;
  ++count_;
  return interval;
}

SyncIntervals SyncMeter::intervals() const noexcept {
  SyncIntervals intervals{.count = count_, .min = min_, .max = max_};
  if (count_ > 0) intervals.mean = sum_ / static_cast<nanoseconds::rep>(count_);
  return intervals;
}

SyncIntervals SyncMeter::Take() noexcept {
  const SyncIntervals taken = intervals();
  count_ = 0;
  min_ = max_ = sum_ = nanoseconds::zero();
  return taken;
}

}  // namespace strainwave::protocols::canopen
