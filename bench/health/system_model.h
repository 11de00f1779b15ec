// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/health/what_if.h"
#include "analysis/statistics/analysis_of_variance.h"
#include "analysis/statistics/gaussian_process.h"
#include "bench/health/health_data.h"

namespace strainwave::bench {

struct SystemSettings {
  int restarts{10};
  std::uint64_t seed{1};
  std::optional<double> limit_rms{};  // default: the worst mean of a condition
  bool unit_means{};                  // the surface through the means of units in place of recordings
};

/// The system's performance over the health of its components.
struct SystemModel {
  analysis::statistics::GaussianProcess surface;
  analysis::health::SystemScale scale;
  std::string limit_is;  // "given", or what it was taken from
  std::string healthy_is;
  bool one_length{};
  double one_length_log_likelihood{};
  double own_lengths_log_likelihood{};
  std::size_t measurements{};
};

/// What was found of the variance; empty where there is nothing to find.
struct SystemVariance {
  std::optional<analysis::statistics::VarianceTable> recordings;
  std::optional<analysis::statistics::VarianceTable> units;  // of their means: units differ, too
};

/// None where the system was not measured, or too little for a surface; `notes` then say so. One length for
/// all components, or one each where the likelihood rises by more than 1 for each further one (Akaike).
std::optional<SystemModel> FitSystem(const HealthData& data, const SystemSettings& settings,
                                     std::vector<std::string>& notes);
SystemVariance VarianceOfSystem(const HealthData& data, std::vector<std::string>& notes);

}  // namespace strainwave::bench
