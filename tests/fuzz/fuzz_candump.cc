// SPDX-License-Identifier: Apache-2.0
// Any text as a log of can-utils; what is read from it, written again, is read as the same.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/candump.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::protocols;
  std::vector<LoggedFrame> log;
  try {
    log = ParseCandump({reinterpret_cast<const char*>(data), size}, "any.log");
  } catch (const std::runtime_error& error) {
    if (!std::string_view(error.what()).starts_with("any.log:")) std::abort();
    return 0;
  }
  std::string written;
  for (const LoggedFrame& frame : log) written += CandumpLine(frame) + "\n";
  if (ParseCandump(written, "written.log") != log) std::abort();
  return 0;
}
