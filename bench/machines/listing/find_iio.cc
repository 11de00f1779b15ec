// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "bench/machines/listing/find_devices.h"
#include "daq/acquisition/sources/iio_devices.h"

namespace strainwave::bench {

FoundPart FindIio() {
  FoundPart part{"iio", {}, {}};
  for (const auto& device : daq::acquisition::FindIioDevices(part.notes)) {
    part.devices.push_back({fmt::format("{}/{}", device.uri, device.device),
                            fmt::format("{}", fmt::join(device.channels, ", ")),
                            {{"uri", device.uri}, {"device", device.device}},
                            {}});
  }
  if (part.devices.empty() && part.notes.empty()) {
    part.notes.emplace_back(
        "there is no IIO device on this machine, on USB or on the network (of a device with an address: "
        "iio_info -u ip:ADDRESS)");
  }
  return part;
}

}  // namespace strainwave::bench
