// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <nlohmann/json.hpp>

#include "bench/campaign/live_envelope.h"

namespace strainwave::bench {

/// What `GET /api/v1/live` answers: `age_s` since it was written (null: not known); `quantities`, each with
/// its `unit`; `recent` and `whole`, of the last minutes and of all of the campaign, both with `bin_s`,
/// `bench_time_s` (where each bin begins) and by quantity `min`, `max`, `last` of each bin, null where a bin
/// has no value. Without envelopes both are null.
nlohmann::json LiveChannelsJson(const std::optional<LiveEnvelopes>& envelopes, const Moment& now);

}  // namespace strainwave::bench
