// SPDX-License-Identifier: Apache-2.0
#include "bench/page/event_stream.h"

#include <charconv>

#include <fmt/core.h>

#include "bench/page/http_text.h"
#include "bench/page/page_state.h"

namespace strainwave::bench {

// JSON as nlohmann writes it on one line holds no line break, so that one data line is enough.
std::string EventFrame(std::string_view name, std::string_view data, std::int64_t id) {
  return id > 0 ? fmt::format("id: {}\nevent: {}\ndata: {}\n\n", id, name, data)
                : fmt::format("event: {}\ndata: {}\n\n", name, data);
}

std::string JournalFrames(std::span<const Event> events, std::int64_t last_seen) {
  std::string frames;
  for (const Event& event : events) {
    if (event.id <= last_seen) continue;
    frames += EventFrame("journal", JsonText(EventJson(event)), event.id);
  }
  return frames;
}

std::int64_t LastEventId(const std::string& header) {
  std::int64_t id{};
  const auto [end, error] = std::from_chars(header.data(), header.data() + header.size(), id);
  return error == std::errc() && end == header.data() + header.size() && id > 0 ? id : 0;
}

}  // namespace strainwave::bench
