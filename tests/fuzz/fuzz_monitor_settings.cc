// SPDX-License-Identifier: Apache-2.0
// Any text as a monitor's settings.
// seeds: bench/monitor/monitor.yaml
// longest: 16384
#include <cstdint>

#include "bench/monitor/settings.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave;
  return CheckText<bench::MonitorSettingsError>(data, size, [](const std::string& text) {
    (void)bench::ParseMonitorSettings(text, "/nowhere/any.yaml");
  });
}
