// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/status_json.h"

#include <nlohmann/json.hpp>

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

nlohmann::json NotesJson(const std::vector<OperatorNote>& notes) {
  nlohmann::json all = nlohmann::json::array();
  for (const OperatorNote& note : notes) {
    all.push_back({{"utc", note.utc}, {"author", note.author}, {"text", note.text}});
  }
  return all;
}

}  // namespace strainwave::bench
