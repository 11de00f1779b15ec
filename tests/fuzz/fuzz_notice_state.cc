// SPDX-License-Identifier: Apache-2.0
// Any text as what a watch of notices has kept; what is accepted, written again, is read as the same.
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <nlohmann/json.hpp>

#include "bench/notices/notice_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::bench;
  try {
    const nlohmann::json json = nlohmann::json::parse(data, data + size);
    const nlohmann::json written = NoticeStateJson(NoticeStateFrom(json));
    if (NoticeStateJson(NoticeStateFrom(written)) != written) std::abort();
  } catch (const std::exception&) {
  }
  return 0;
}
