// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <linux/uhid.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace strainwave {

/// A USB device of the kernel's uhid: plugged in as long as it lives. Needs /dev/uhid.
class UhidDevice {
 public:
  UhidDevice(const std::string& name, std::uint16_t vendor, std::uint16_t product, const std::string& serial,
             std::span<const std::uint8_t> descriptor)
      : file_(::open("/dev/uhid", O_RDWR | O_CLOEXEC)) {
    uhid_event event{};
    event.type = UHID_CREATE2;
    std::strncpy(reinterpret_cast<char*>(event.u.create2.name), name.c_str(),
                 sizeof(event.u.create2.name) - 1);
    std::strncpy(reinterpret_cast<char*>(event.u.create2.uniq), serial.c_str(),
                 sizeof(event.u.create2.uniq) - 1);
    std::ranges::copy(descriptor, event.u.create2.rd_data);
    event.u.create2.rd_size = static_cast<std::uint16_t>(descriptor.size());
    event.u.create2.bus = 3;  // USB
    event.u.create2.vendor = vendor;
    event.u.create2.product = product;
    made_ = file_ >= 0 && Write(event);
  }
  UhidDevice(const UhidDevice&) = delete;
  UhidDevice& operator=(const UhidDevice&) = delete;
  ~UhidDevice() { ::close(file_); }

  bool made() const { return made_; }
  int file() const { return file_; }

  bool Write(const uhid_event& event) { return ::write(file_, &event, sizeof(event)) == sizeof(event); }
  bool SendReport(std::span<const std::uint8_t> report) {
    uhid_event event{};
    event.type = UHID_INPUT2;
    event.u.input2.size = static_cast<std::uint16_t>(report.size());
    std::ranges::copy(report, event.u.input2.data);
    return Write(event);
  }

 private:
  int file_;
  bool made_{};
};

}  // namespace strainwave
