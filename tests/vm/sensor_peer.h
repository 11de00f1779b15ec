// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <thread>

namespace strainwave::daq::acquisition {

/// A USB accelerometer as the HID Sensor Usages describe it, made of the kernel's uhid, which the kernel
/// turns into an IIO device `accel_3d`. At every interval it sends counts: k, −k and 1000 at its k-th report.
/// Plugged in as long as it lives. Needs /dev/uhid.
class SensorPeer {
 public:
  explicit SensorPeer(std::chrono::milliseconds interval)
      : interval_(interval), file_(::open("/dev/uhid", O_RDWR | O_CLOEXEC)) {
    uhid_event event{};
    event.type = UHID_CREATE2;
    std::strncpy(reinterpret_cast<char*>(event.u.create2.name), "strainwave sensor",
                 sizeof(event.u.create2.name) - 1);
    std::ranges::copy(kDescriptor, event.u.create2.rd_data);
    event.u.create2.rd_size = sizeof(kDescriptor);
    event.u.create2.bus = 3;  // USB
    event.u.create2.vendor = 0x1209;
    event.u.create2.product = 0x5702;
    made_ = file_ >= 0 && ::write(file_, &event, sizeof(event)) == sizeof(event);
    thread_ = std::thread([this] { Serve(); });
  }
  SensorPeer(const SensorPeer&) = delete;
  SensorPeer& operator=(const SensorPeer&) = delete;
  ~SensorPeer() {
    ends_ = true;
    thread_.join();
    ::close(file_);
  }

  bool made() const { return made_; }
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
      pollfd waited{file_, POLLIN, 0};
      uhid_event event{};
      if (::poll(&waited, 1, static_cast<int>(left.count())) > 0 && ::read(file_, &event, sizeof(event)) > 0)
        Answer(event);
    }
  }

  void Send() {
    const std::int32_t k = ++sent_;
    if (mute_) return;
    uhid_event event{};
    event.type = UHID_INPUT2;
    const std::array<std::int32_t, 3> counts{k, -k, 1000};
    event.u.input2.size = 1 + sizeof(counts);
    event.u.input2.data[0] = kReport;
    std::memcpy(event.u.input2.data + 1, counts.data(), sizeof(counts));
    Write(event);
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
    Write(event);
  }

  void Write(const uhid_event& event) {
    if (::write(file_, &event, sizeof(event)) != sizeof(event)) ends_ = true;
  }

  std::chrono::milliseconds interval_;
  int file_;
  bool made_{};
  std::atomic<std::int32_t> sent_{};
  std::atomic<bool> mute_{false};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace strainwave::daq::acquisition
