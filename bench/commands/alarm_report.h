// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "bench/alarms/alarm_list.h"
#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// In words, with who and when: "shelved until 2026-11-02T10:30:00.000Z by A. Meier, unacknowledged".
std::string StateText(const AlarmInstance& instance);

/// For people, indented by two: a line an alarm, what it says to do, and what was said about it.
std::string AlarmText(std::span<const AlarmInstance> instances, std::span<const AlarmRule> rules,
                      std::span<const AlarmAction> actions);

/// As one document on standard output; bytes that are no UTF-8 are replaced.
std::string DocumentOf(const nlohmann::json& json);

}  // namespace strainwave::bench
