// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "bench/roles/bench_clock.h"

namespace strainwave::bench {

/// Which device, and what it must be asked. Names of makers' numbers as `lsusb` prints them.
struct HidSettings {
  std::uint16_t vendor{}, product{};
  std::string serial;                         // empty: any
  std::vector<std::uint8_t> request;          // output report, id first; empty: it reports by itself
  std::chrono::nanoseconds request_period{};  // above zero where there is a request
};

/// Who hears a device. Called from the device's thread; times are those of `BenchClock`.
class HidListener {
 public:
  HidListener() = default;
  HidListener(const HidListener&) = delete;
  HidListener& operator=(const HidListener&) = delete;
  virtual ~HidListener() = default;

  virtual void Plugged(std::chrono::nanoseconds time) = 0;
  virtual void Report(std::span<const std::uint8_t> report, std::chrono::nanoseconds time) = 0;
  /// Also when it cannot be read any more.
  virtual void Unplugged(std::chrono::nanoseconds time) = 0;
};

/// One HID device through hidapi, read from a thread of its own. May be unplugged and plugged in again at any
/// time, at any port; it is known by its numbers.
class HidDevice {
 public:
  /// @param listener, clock  outlive the device.
  HidDevice(HidSettings settings, const BenchClock& clock, HidListener& listener);
  HidDevice(const HidDevice&) = delete;
  HidDevice& operator=(const HidDevice&) = delete;
  ~HidDevice();

  bool connected() const noexcept { return connected_; }

 private:
  void Run();
  void Read(void* device);

  const HidSettings settings_;
  const BenchClock& clock_;
  HidListener& listener_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> connected_{false};
  std::thread thread_;
};

/// A device that is plugged in, for a list.
struct FoundHidDevice {
  std::uint16_t vendor{}, product{};
  std::string serial, maker, name, path;
};
std::vector<FoundHidDevice> FindHidDevices();

}  // namespace strainwave::bench
