// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/campaign/journal.h"
#include "bench/campaign/quality.h"
#include "bench/campaign/source_states.h"

/// Parts of a campaign's status as JSON, alike for `status --json` and for the live page.
namespace strainwave::bench {

/// How far the last cycle is from ending the campaign: quantity, value, `below` or `above`, unit.
nlohmann::json StopsJson(const std::vector<StopDistance>& stops);
/// channel, reason, since_utc
nlohmann::json ChannelsJson(const std::vector<ChannelTrouble>& channels);
/// source, state, words, channels; of a stream, else null, samples: received, lost, late, gaps, resets,
/// since_utc, last_loss_utc (null: none was lost)
nlohmann::json SourcesJson(const std::vector<SourceState>& sources, std::int64_t since_utc_ms);
/// utc, author, text
nlohmann::json NotesJson(const std::vector<OperatorNote>& notes);

}  // namespace strainwave::bench
