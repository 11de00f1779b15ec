// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/hid/hid_device.h"

#include <hidapi/hidapi.h>

#include <array>
#include <memory>
#include <mutex>
#include <utility>

namespace strainwave::bench {
namespace {

constexpr int kPatience_ms = 20;  // in which a stop of this program is seen; a report is taken at once
constexpr std::chrono::milliseconds kLookAgain{50};

// hidapi looks for, opens and closes devices from one thread at a time.
std::mutex& HidapiMutex() {
  static std::mutex mutex;
  return mutex;
}

struct CloseHid {
  void operator()(hid_device* device) const {
    const std::lock_guard lock(HidapiMutex());
    hid_close(device);
  }
};
using HidHandle = std::unique_ptr<hid_device, CloseHid>;

std::string Narrow(const wchar_t* text) {
  std::string narrow;
  for (; text != nullptr && *text != L'\0'; ++text) narrow += *text < 128 ? static_cast<char>(*text) : '?';
  return narrow;
}

// With the mutex held.
std::vector<FoundHidDevice> Find(std::uint16_t vendor, std::uint16_t product) {
  std::vector<FoundHidDevice> found;
  hid_device_info* const list = hid_enumerate(vendor, product);
  for (const hid_device_info* info = list; info != nullptr; info = info->next) {
    found.push_back({info->vendor_id, info->product_id, Narrow(info->serial_number),
                     Narrow(info->manufacturer_string), Narrow(info->product_string),
                     info->path != nullptr ? info->path : ""});
  }
  hid_free_enumeration(list);
  return found;
}

HidHandle Open(const HidSettings& settings) {
  const std::lock_guard lock(HidapiMutex());
  for (const FoundHidDevice& found : Find(settings.vendor, settings.product)) {
    if (!settings.serial.empty() && found.serial != settings.serial) continue;
    if (hid_device* const device = hid_open_path(found.path.c_str())) return HidHandle(device);
  }
  return nullptr;
}

}  // namespace

std::vector<FoundHidDevice> FindHidDevices() {
  const std::lock_guard lock(HidapiMutex());
  return Find(0, 0);
}

HidDevice::HidDevice(HidSettings settings, const BenchClock& clock, HidListener& listener)
    : settings_(std::move(settings)), clock_(clock), listener_(listener), thread_([this] { Run(); }) {}

HidDevice::~HidDevice() {
  stop_ = true;
  thread_.join();
}

void HidDevice::Run() {
  while (!stop_) {
    const HidHandle device = Open(settings_);
    if (device == nullptr) {
      std::this_thread::sleep_for(kLookAgain);
      continue;
    }
    listener_.Plugged(clock_.Now());
    connected_ = true;
    Read(device.get());
    connected_ = false;
    listener_.Unplugged(clock_.Now());
  }
}

void HidDevice::Read(void* handle) {
  auto* const device = static_cast<hid_device*>(handle);
  std::array<std::uint8_t, 1024> report;
  std::chrono::nanoseconds next_request = clock_.Now();
  while (!stop_) {
    if (!settings_.request.empty() && clock_.Now() >= next_request) {
      if (hid_write(device, settings_.request.data(), settings_.request.size()) < 0) return;
      next_request = clock_.Now() + settings_.request_period;
    }
    const int length = hid_read_timeout(device, report.data(), report.size(), kPatience_ms);
    if (length < 0) return;
    if (length > 0) listener_.Report(std::span(report).first(static_cast<std::size_t>(length)), clock_.Now());
  }
}

}  // namespace strainwave::bench
