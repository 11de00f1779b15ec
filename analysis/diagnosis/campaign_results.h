// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <string>
#include <vector>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// One result of a campaign in its own unit, at the cycles that have it.
struct ResultSeries {
  std::string name;                 // "k2_Nm_per_rad"
  std::string unit;                 // "Nm/rad"
  std::vector<std::size_t> row;     // of the campaign's data
  std::vector<std::size_t> sample;  // of the campaign's study
  std::vector<double> value;
};

/// What a response of the campaign's study, which is without units and mixes the results, says of each
/// result.
/// @param response  measured, or as a model predicts it; one value a sample of the study.
std::vector<ResultSeries> ResultsOf(const CampaignData& campaign, const Eigen::VectorXd& response);

}  // namespace strainwave::analysis::diagnosis
