// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/listing/find_devices.h"
#include "daq/acquisition/sources/iio_contexts.h"

namespace strainwave::bench {

FoundPart FindIio() {
  FoundPart part{"iio", {}, {}};
  for (const auto& context : daq::acquisition::FindIioContexts(part.notes)) {
    part.devices.push_back({context.uri, context.description, {{"uri", context.uri}}, {}});
  }
  if (part.devices.empty() && part.notes.empty()) {
    part.notes.emplace_back(
        "there is no IIO device on this machine, on USB or on the network (of a device with an address: "
        "iio_info -u ip:ADDRESS)");
  }
  return part;
}

}  // namespace strainwave::bench
