// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// Server-sent events (WHATWG HTML, "Server-sent events"): the frames of `GET /api/v1/events`.
///
///     event: state     all of /api/v1/state; on connecting, and whenever it has changed
///     event: journal   a line of the journal; its number in the journal is the event's id
///     event: alive     {"now_ms"}, once a second, so that a page knows that the stream lives
///
/// Only lines of the journal have an id: a browser that comes back says with Last-Event-ID which it has seen,
/// and gets those since. Of the state there is only one, the newest.
std::string EventFrame(std::string_view name, std::string_view data, std::int64_t id = 0);

/// Frames of the lines that came after `last_seen`, oldest first.
std::string JournalFrames(std::span<const Event> events, std::int64_t last_seen);

/// What a browser sends as Last-Event-ID; 0 where that is no number of a line.
std::int64_t LastEventId(const std::string& header);

}  // namespace strainwave::bench
