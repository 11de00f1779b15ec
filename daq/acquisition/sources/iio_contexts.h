// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace strainwave::daq::acquisition {

/// An IIO context that was found: what IioSettings::uri takes, and what libiio says is there.
struct IioContextInfo {
  std::string uri;
  std::string description;
};

/// Contexts of this machine, on USB, and those that say on the network that they are there; takes seconds.
/// @param troubles  gets what could not be looked at, in words.
std::vector<IioContextInfo> FindIioContexts(std::vector<std::string>& troubles);

}  // namespace strainwave::daq::acquisition
