// SPDX-License-Identifier: Apache-2.0
// Any bytes as a Sparkplug payload or the word of a host; metrics that are read, written again, are read as
// the same.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "protocols/sparkplug.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::protocols;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)ParseHostState(bytes);
  (void)AsksForRebirth(bytes);
  const auto payload = ParseSparkplug(bytes);
  if (!payload) return 0;
  const auto again = ParseSparkplug(EncodeMetrics(payload->metrics));
  if (!again || again->metrics.size() != payload->metrics.size()) std::abort();
  for (std::size_t i = 0; i < again->metrics.size(); ++i) {
    if (again->metrics[i].name != payload->metrics[i].name) std::abort();
  }
  return 0;
}
