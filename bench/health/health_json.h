// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "bench/health/train_health.h"

namespace strainwave::bench {

/// What `health train --json` prints (docs/contract.md#health-faults-and-fingerprints).
nlohmann::ordered_json ReportOf(const HealthData& data, const HealthJob& job, const HealthOutcome& outcome);

/// What the predictor's folder and its card say of the training.
nlohmann::ordered_json TrainingJsonOf(const HealthData& data, const HealthJob& job,
                                      const HealthOutcome& outcome);

/// Surface, scale and what they rest on.
nlohmann::ordered_json JsonOf(const SystemModel& system, const std::vector<std::string>& components);
/// @throws nlohmann's exception for another structure; std::invalid_argument.
SystemModel SystemFrom(const nlohmann::ordered_json& json, std::size_t components);

}  // namespace strainwave::bench
