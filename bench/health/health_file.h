// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/health/health_data.h"
#include "bench/health/system_model.h"
#include "bench/health/train_health.h"
#include "bench/prediction/predictor_file.h"

namespace strainwave::bench {

/// What `health train` has written.
struct HealthModel {
  Predictor predictor;  // of the health of each component
  std::vector<std::string> components;
  std::optional<SystemModel> system;
  Eigen::MatrixXd failed;  // conditions in which the system failed × components
  nlohmann::ordered_json report;
};

/// Writes a predictor's files, then `health.json`, which is sealed and holds the SHA-256 of the others: each
/// file appears whole, and a folder without the last, or with parts of two trainings, is refused.
void WriteHealthModel(const std::filesystem::path& folder, const HealthData& data, const HealthJob& job,
                      const HealthOutcome& outcome);

/// @throws BenchError if a file is missing, of another format, changed, or does not fit the others.
HealthModel ReadHealthModel(const std::filesystem::path& folder);

}  // namespace strainwave::bench
