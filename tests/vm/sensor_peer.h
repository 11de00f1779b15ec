// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <thread>

#include "tests/vm/uhid_device.h"

namespace strainwave::daq::acquisition {

/// A USB accelerometer as the HID Sensor Usages describe it, made of the kernel's uhid, which the kernel
/// turns into an IIO device `accel_3d`. At every interval it sends counts: k, −k and 1000 at its k-th report.
/// Plugged in as long as it lives. Needs /dev/uhid.
class SensorPeer {
 public:
  explicit SensorPeer(std::chrono::milliseconds interval)
      : interval_(interval),
        device_("strainwave sensor", 0x1209, 0x5702, "", kDescriptor),
        thread_([this] { Serve(); }) {}
  SensorPeer(const SensorPeer&) = delete;
  SensorPeer& operator=(const SensorPeer&) = delete;
  ~SensorPeer() {
    ends_ = true;
    thread_.join();
  }

  bool made() const { return device_.made(); }
  /// While it is mute its reports are lost, and counted as if they had gone out.
  void Mute(bool mute) { mute_ = mute; }
  std::int32_t sent() const { return sent_; }

 private:
  static constexpr std::uint8_t kReport = 1;
  // clang-format off
  static constexpr std::uint8_t kDescriptor[] = {
      0x05, 0x20, 0x09, 0x01, 0xA1, 0x01,        // sensors; application collection: sensor
      0x85, kReport, 0x09, 0x73, 0xA1, 0x00,     // physical collection: accelerometer 3D
      0x0A, 0x0E, 0x03,                          // report interval,
      0x15, 0x00, 0x27, 0xFF, 0xFF, 0xFF, 0x7F,  // from 0 on,
      0x75, 0x20, 0x95, 0x01, 0xB1, 0x02,        // 32 bits, one, feature
      0x25, 0x05, 0x75, 0x08,                    // 0 to 5, 8 bits:
      0x0A, 0x19, 0x03, 0xA1, 0x02,              // power state, one of
      0x0A, 0x50, 0x08, 0x0A, 0x51, 0x08, 0x0A, 0x52, 0x08,
      0x0A, 0x53, 0x08, 0x0A, 0x54, 0x08, 0x0A, 0x55, 0x08, 0xB1, 0x00, 0xC0,
      0x0A, 0x16, 0x03, 0xA1, 0x02,              // reporting state, one of
      0x0A, 0x40, 0x08, 0x0A, 0x41, 0x08, 0x0A, 0x42, 0x08,
      0x0A, 0x43, 0x08, 0x0A, 0x44, 0x08, 0x0A, 0x45, 0x08, 0xB1, 0x00, 0xC0,
      0x17, 0x00, 0x00, 0x00, 0x80, 0x27, 0xFF, 0xFF, 0xFF, 0x7F,
      0x75, 0x20, 0x55, 0x0D,                    // 32 bits with sign, thousandths
      0x0A, 0x53, 0x04, 0x81, 0x02,              // acceleration x, input
      0x0A, 0x54, 0x04, 0x81, 0x02,              // y
      0x0A, 0x55, 0x04, 0x81, 0x02,              // z
      0xC0, 0xC0};
  // clang-format on

  void Serve() {
    auto next = std::chrono::steady_clock::now();
    while (!ends_) {
      const auto now = std::chrono::steady_clock::now();
      if (now >= next) {
        Send();
        next += interval_;
        continue;
      }
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(next - now);
      pollfd waited{device_.file(), POLLIN, 0};
      uhid_event event{};
      if (::poll(&waited, 1, static_cast<int>(left.count())) > 0 &&
          ::read(device_.file(), &event, sizeof(event)) > 0)
        Answer(event);
    }
  }

  void Send() {
    const std::int32_t k = ++sent_;
    if (mute_) return;
    const std::array<std::int32_t, 3> counts{k, -k, 1000};
    std::array<std::uint8_t, 1 + sizeof(counts)> report{kReport};
    std::memcpy(report.data() + 1, counts.data(), sizeof(counts));
    if (!device_.SendReport(report)) ends_ = true;
  }

  void Answer(const uhid_event& asked) {
    uhid_event event{};
    if (asked.type == UHID_GET_REPORT) {
      event.type = UHID_GET_REPORT_REPLY;
      event.u.get_report_reply.id = asked.u.get_report.id;
      // The interval; the first of the power states and of the reporting states.
      const auto interval_ms = static_cast<std::uint32_t>(interval_.count());
      event.u.get_report_reply.size = 1 + sizeof(interval_ms) + 2;
      event.u.get_report_reply.data[0] = kReport;
      std::memcpy(event.u.get_report_reply.data + 1, &interval_ms, sizeof(interval_ms));
    } else if (asked.type == UHID_SET_REPORT) {
      event.type = UHID_SET_REPORT_REPLY;
      event.u.set_report_reply.id = asked.u.set_report.id;
    } else {
      return;
    }
    if (!device_.Write(event)) ends_ = true;
  }

  std::chrono::milliseconds interval_;
  std::atomic<std::int32_t> sent_{};
  std::atomic<bool> mute_{false};
  std::atomic<bool> ends_{false};
  UhidDevice device_;
  std::thread thread_;  // the last: it uses the others
};

}  // namespace strainwave::daq::acquisition
