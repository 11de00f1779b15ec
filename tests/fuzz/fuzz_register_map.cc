// SPDX-License-Identifier: Apache-2.0
// Any text as the file of a Modbus device.
// seeds: bench/devices/profiles/modbus_*.yaml bench/devices/profiles/strainwave_climate.yaml
// longest: 16384
#include <cstdint>

#include "bench/configuration/read_register_map.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave;
  return CheckText<bench::ModbusProfileError>(
      data, size, [](const std::string& text) { (void)bench::ParseModbusProfile(text, "any.yaml"); });
}
