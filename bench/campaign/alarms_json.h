// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "bench/alarms/alarm_list.h"
#include "bench/campaign/journal.h"
#include "bench/campaign/pause.h"

namespace strainwave::bench {

/// Of one that is shelved.
std::string ShelfEndUtc(const AlarmShelf& shelf);

/// docs/bench/alarms.md#json
nlohmann::json AlarmsJson(std::span<const AlarmInstance> instances, std::span<const AlarmRule> rules,
                          std::span<const AlarmAction> actions);

/// {"alarms", "raised_ever"}: those that are open, or all. @param now  by which shelves are over.
nlohmann::json AlarmListJson(const Journal& journal, std::span<const AlarmRule> rules, bool all,
                             const Moment& now);

}  // namespace strainwave::bench
