// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/status_json.h"

#include <nlohmann/json.hpp>

#include "bench/utc.h"

namespace strainwave::bench {

using nlohmann::json;

json StopsJson(const std::vector<StopDistance>& stops) {
  json all = json::array();
  for (const StopDistance& stop : stops) {
    all.push_back({{"quantity", stop.quantity},
                   {"value", stop.value},
                   {stop.is_lower ? "below" : "above", stop.limit},
                   {"unit", stop.unit}});
  }
  return all;
}

json ChannelsJson(const std::vector<ChannelTrouble>& channels) {
  json all = json::array();
  for (const ChannelTrouble& bad : channels) {
    all.push_back({{"channel", bad.channel}, {"reason", bad.reason}, {"since_utc", bad.since_utc}});
  }
  return all;
}

json SourcesJson(const std::vector<SourceState>& sources, std::int64_t since_utc_ms) {
  json all = json::array();
  for (const SourceState& source : sources) {
    json samples;
    if (source.counts) {
      const daq::acquisition::GapTotals& totals = source.counts->samples;
      const std::int64_t last_loss = source.counts->last_loss_utc_ms;
      samples = {{"received", totals.received},
                 {"lost", totals.lost},
                 {"late", totals.repeated},
                 {"gaps", totals.gaps},
                 {"resets", totals.resets},
                 {"since_utc", UtcText(since_utc_ms)},
                 {"last_loss_utc", last_loss > 0 ? json(UtcText(last_loss)) : json()}};
    }
    all.push_back({{"source", source.source},
                   {"state", NameOf(source.condition)},
                   {"words", source.words},
                   {"channels", source.channels},
                   {"samples", std::move(samples)}});
  }
  return all;
}

nlohmann::json NotesJson(const std::vector<OperatorNote>& notes) {
  nlohmann::json all = nlohmann::json::array();
  for (const OperatorNote& note : notes) {
    all.push_back({{"utc", note.utc}, {"author", note.author}, {"text", note.text}});
  }
  return all;
}

}  // namespace strainwave::bench
