// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "bench/devices/hid/hid_device.h"
#include "bench/realtime/latest.h"
#include "bench/roles/channel_value.h"
#include "protocols/hid_report.h"

namespace strainwave::bench {

/// A measuring device on HID: what its reports hold.
struct HidProfile {
  std::string name;
  HidSettings device;
  std::vector<protocols::HidField> channels;
  std::chrono::nanoseconds good_for{};  // an older value is stale
};

/// The newest value of each channel of a device.
class HidChannels : private HidListener {
 public:
  /// @param clock  outlives the channels.
  HidChannels(const HidProfile& profile, const BenchClock& clock);
  ~HidChannels() override = default;

  /// By position in the profile. Never waits.
  ChannelValue Value(std::size_t index) const noexcept;
  bool connected() const noexcept { return device_.connected(); }

 private:
  void Plugged(std::chrono::nanoseconds) override {}
  void Report(std::span<const std::uint8_t> report, std::chrono::nanoseconds time) override;
  void Unplugged(std::chrono::nanoseconds time) override;

  const HidProfile profile_;
  const BenchClock& clock_;
  std::deque<Latest<ChannelValue>> values_;
  HidDevice device_;  // last: its thread uses all of the above
};

}  // namespace strainwave::bench
