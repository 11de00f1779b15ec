// SPDX-License-Identifier: Apache-2.0
// What a bench of metal waits for before anything may move: the first value of every channel and drive, none
// of which is judged before it can have come.
#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/machines/field/field_machine.h"

namespace strainwave::bench {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

constexpr nanoseconds kFirstValue = std::chrono::seconds(3);  // a converter starts, a device connects
constexpr milliseconds kLook{2};

// Whose age stops the bench; of the others their devices' files say how old they may be.
constexpr std::string_view kGuardNames[] = {"input_angle", "output_angle", "input_speed", "output_torque"};

double Milliseconds(nanoseconds time) { return std::chrono::duration<double, std::milli>(time).count(); }

}  // namespace

// A slow sensor may take as long to its first report as to any other.
nanoseconds FieldMachine::LongestToFirstValue() const {
  nanoseconds longest = std::max(kFirstValue, stale_after_);
  for (const auto& [name, hid] : hid_) longest = std::max(longest, hid.profile.good_for);
  for (const auto& [name, client] : modbus_) {
    for (const auto& value : client->map().registers) longest = std::max(longest, GoodFor(value));
  }
  return longest;
}

// Devices whose newest value is as old as `stale_after` before the next can be there, a control period for
// the way included.
std::vector<std::string> FieldMachine::TooSlow() const {
  const nanoseconds way(static_cast<std::int64_t>(1e9 * bench_.control_period_s));
  std::vector<std::string> slow;
  const auto check = [&](nanoseconds period, const std::string& who, const char* mend) {
    if (period + way <= stale_after_) return;
    slow.push_back(
        fmt::format("{}, but stale_after is {:g} ms: its values cannot stay fresh (expected {}, or "
                    "stale_after of at least {:g} ms in the bench file)",
                    who, Milliseconds(stale_after_), mend, Milliseconds(period + way)));
  };
  for (const auto& [name, reader] : sources_) {
    const double block_s = reader->Newest().block_s;
    check(nanoseconds(static_cast<std::int64_t>(1e9 * block_s)),
          fmt::format("{} sends its samples in blocks of {:g} ms ({:.0f} at {:g} Hz)", name, 1e3 * block_s,
                      block_s * reader->description().rate_hz, reader->description().rate_hz),
          "shorter blocks");
  }
  const auto asked = [&](const std::string& who, nanoseconds period) {
    check(period, fmt::format("{} is asked every {:g} ms", who, Milliseconds(period)), "to ask more often");
  };
  for (const auto& [name, servo] : modbus_servos_) asked("the " + name, servo->poll_period());
  for (const ChannelLink& link : bench_.channels) {
    if (std::ranges::find(kGuardNames, link.channel) == std::end(kGuardNames)) continue;
    if (const auto amplifier = amplifiers_.find(link.device); amplifier != amplifiers_.end()) {
      asked(link.device, amplifier->second->poll_period());
    } else if (const auto client = modbus_.find(link.device); client != modbus_.end()) {
      const auto& registers = client->second->map().registers;
      asked(link.device, registers[*RegisterOf(*client->second, link.source)].poll_period);
    } else if (const auto hid = hid_.find(link.device); hid != hid_.end()) {
      asked(link.device, hid->second.profile.device.request_period);
    }
  }
  return slow;
}

std::vector<std::string> FieldMachine::NotYet() const {
  std::vector<std::string> missing = TooSlow();
  for (const BadChannel& bad : BadChannels()) {
    missing.push_back(fmt::format("{} ({})", bad.channel, bad.reason));
  }
  for (const auto& [name, drive] : {std::pair{"driving servo", driving_}, {"load servo", load_}}) {
    if (clock_.Now() - drive->Actual().time >= stale_after_) {
      missing.push_back(fmt::format("the {} (it says nothing of its state)", name));
    }
  }
  if (missing.empty() && sampler_->Read().bad_channels != 0) {
    missing.emplace_back("vibration (no whole tenth of a second of it)");
  }
  return missing;
}

std::string FieldMachine::AwaitValues(const std::function<bool()>& given_up) {
  const nanoseconds begin = clock_.Now();
  const nanoseconds longest = LongestToFirstValue();
  std::vector<std::string> missing = NotYet();
  while (!missing.empty()) {
    if (given_up()) return {};
    if (clock_.Now() - begin >= longest) {
      return fmt::format("after {:g} s the bench cannot start for want of: {}",
                         std::chrono::duration<double>(longest).count(), fmt::join(missing, "; "));
    }
    clock_.SleepUntil(clock_.Now() + kLook);
    missing = NotYet();
  }
  return {};
}

}  // namespace strainwave::bench
