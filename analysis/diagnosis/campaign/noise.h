// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "analysis/diagnosis/campaign/layout.h"

namespace strainwave::analysis::diagnosis {

/// How the results of a campaign scatter from cycle to cycle.
struct CampaignNoise {
  std::vector<double> scatter;  // of each series, from neighbouring cycles, in its unit
  std::vector<double> scale;    // what each series is divided by: scatter, or more where that is uncertain
  double floor{1.0};            // of the scaled series
  Eigen::MatrixXd correlation;  // of the scatter of the series in one cycle; zero where not clear
  /// How much more often a single series exceeds what chance allows than if its scatter were known exactly.
  double single_tail{1.0};
  double run_in_share{};  // time constant of the run-in that fits all series best together
};

/// @param values           one row a series, NaN where a cycle has no value.
/// @param standard_errors  median of each series, 0 where unknown.
/// @param layout           cycles, load time, temperature.
CampaignNoise EstimateCampaignNoise(const std::vector<std::vector<double>>& values,
                                    std::span<const double> standard_errors, const CampaignLayout& layout);

/// Median of the positive finite ones; 0 if there is none.
double MedianError(std::span<const double> standard_errors);

}  // namespace strainwave::analysis::diagnosis
