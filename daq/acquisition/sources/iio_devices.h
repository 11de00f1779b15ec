// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace strainwave::daq::acquisition {

/// An IIO device that was found, with something to scan: what IioSettings takes.
struct IioDeviceInfo {
  std::string uri;
  std::string device;                 // its name, or its id where it has none
  std::vector<std::string> channels;  // ids
};

/// Devices of this machine, on USB, and of those that say on the network that they are there; takes seconds.
/// @param troubles  gets what could not be looked at, in words.
std::vector<IioDeviceInfo> FindIioDevices(std::vector<std::string>& troubles);

}  // namespace strainwave::daq::acquisition
