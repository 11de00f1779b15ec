// SPDX-License-Identifier: Apache-2.0
// Any text as the settings of notices.
// seeds: bench/notices/notices.yaml
// longest: 16384
#include <cstdint>

#include "bench/notices/notice_settings.h"
#include "tests/fuzz/text_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave;
  return CheckText<bench::NoticeSettingsError>(data, size, [](const std::string& text) {
    (void)bench::ParseNoticeSettings(text, "/nowhere/any.yaml");
  });
}
