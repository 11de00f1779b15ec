// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// Measured less predicted, SI, one a sample.
inline std::vector<double> ResidualsOf(const Study& study, const ModelFit& fit) {
  const std::span<const double> measured = study.measured();
  std::vector<double> residuals(measured.begin(), measured.end());
  for (std::size_t i = 0; i < residuals.size(); ++i)
    residuals[i] -= fit.predicted(static_cast<Eigen::Index>(i));
  return residuals;
}

}  // namespace strainwave::analysis::diagnosis
