// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/hid/hid_channels.h"

namespace strainwave::bench {

using protocols::HidProblem;
using std::chrono::nanoseconds;

HidChannels::HidChannels(const HidProfile& profile, const BenchClock& clock)
    : profile_(profile),
      clock_(clock),
      values_(profile.channels.size()),
      device_(profile.device, clock, *this) {}

void HidChannels::Report(std::span<const std::uint8_t> report, nanoseconds time) {
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const protocols::HidValue value = TakeField(profile_.channels[i], report);
    if (value.problem == HidProblem::kOtherReport) continue;
    values_[i].Set({value.value, time, value.problem == HidProblem::kNone});
  }
}

void HidChannels::Unplugged(nanoseconds time) {
  for (Latest<ChannelValue>& value : values_) value.Set({ChannelValue{}.value, time, false});
}

ChannelValue HidChannels::Value(std::size_t index) const noexcept {
  ChannelValue value = values_[index].Get();
  if (clock_.Now() - value.time > profile_.good_for) value.good = false;
  return value;
}

}  // namespace strainwave::bench
