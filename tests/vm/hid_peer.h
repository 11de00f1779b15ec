// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace strainwave::bench {

/// A HID device made of the kernel's uhid: plugged in as long as it lives. Needs /dev/uhid.
class HidPeer {
 public:
  /// Reports of `report_bytes` bytes in and out, without numbers.
  HidPeer(std::uint16_t vendor, std::uint16_t product, const std::string& serial, std::uint8_t report_bytes)
      : file_(::open("/dev/uhid", O_RDWR | O_CLOEXEC)) {
    const std::uint8_t descriptor[] = {0x06, 0x00, 0xFF,        // usage page: the maker's own
                                       0x09, 0x01, 0xA1, 0x01,  // usage 1, collection: application
                                       0x15, 0x00, 0x26, 0xFF,         0x00,
                                       0x75, 0x08, 0x95, report_bytes,  // bytes from 0 to 255, so many
                                       0x09, 0x01, 0x81, 0x02,          // input
                                       0x09, 0x02, 0x91, 0x02,          // output
                                       0xC0};
    uhid_event event{};
    event.type = UHID_CREATE2;
    std::strncpy(reinterpret_cast<char*>(event.u.create2.name), "strainwave peer",
                 sizeof(event.u.create2.name) - 1);
    std::strncpy(reinterpret_cast<char*>(event.u.create2.uniq), serial.c_str(),
                 sizeof(event.u.create2.uniq) - 1);
    std::copy(std::begin(descriptor), std::end(descriptor), event.u.create2.rd_data);
    event.u.create2.rd_size = sizeof(descriptor);
    event.u.create2.bus = 3;  // USB
    event.u.create2.vendor = vendor;
    event.u.create2.product = product;
    made_ = file_ >= 0 && ::write(file_, &event, sizeof(event)) == sizeof(event);
  }
  HidPeer(const HidPeer&) = delete;
  HidPeer& operator=(const HidPeer&) = delete;
  ~HidPeer() { ::close(file_); }

  bool made() const { return made_; }

  bool Send(std::span<const std::uint8_t> report) {
    uhid_event event{};
    event.type = UHID_INPUT2;
    event.u.input2.size = static_cast<std::uint16_t>(report.size());
    std::ranges::copy(report, event.u.input2.data);
    return ::write(file_, &event, sizeof(event)) == sizeof(event);
  }

  /// The next output report that somebody sends to the device, or nothing within the time.
  std::vector<std::uint8_t> Take(std::chrono::milliseconds longest) {
    const auto end = std::chrono::steady_clock::now() + longest;
    for (;;) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      pollfd waited{file_, POLLIN, 0};
      uhid_event event{};
      if (left.count() <= 0 || ::poll(&waited, 1, static_cast<int>(left.count())) <= 0) return {};
      if (::read(file_, &event, sizeof(event)) <= 0) return {};
      if (event.type != UHID_OUTPUT) continue;
      return {event.u.output.data, event.u.output.data + event.u.output.size};
    }
  }

 private:
  int file_;
  bool made_{};
};

}  // namespace strainwave::bench
