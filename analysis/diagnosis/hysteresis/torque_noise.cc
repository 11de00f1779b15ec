// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/torque_noise.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {

std::vector<double> CompliancesOf(const LoopRecords& records, const Eigen::VectorXd& gear_rad) {
  const LoopGrid& samples = records.samples;
  const double usual = records.compliance_rad_per_Nm();
  double compliance_rad_per_Nm = usual;
  std::vector<double> compliances;
  for (Eigen::Index i = 0; i < gear_rad.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (i > 0 && samples.torque_Nm[k] != samples.torque_Nm[k - 1] && std::isnan(samples.turn_Nm[k])) {
      const double slope =
          (gear_rad(i) - gear_rad(i - 1)) / (samples.torque_Nm[k] - samples.torque_Nm[k - 1]);
      compliance_rad_per_Nm = std::clamp(slope, 0.0, 3.0 * usual);
    }
    compliances.push_back(compliance_rad_per_Nm);
  }
  return compliances;
}

Eigen::VectorXd ResponseToTorqueNoise(const LoopRecords& records,
                                      std::span<const double> compliances_rad_per_Nm) {
  Eigen::VectorXd response_rad(static_cast<Eigen::Index>(compliances_rad_per_Nm.size()));
  for (Eigen::Index i = 0; i < response_rad.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    response_rad(i) = compliances_rad_per_Nm[k] * records.torque_noise_Nm[k];
  }
  return response_rad;
}

std::vector<double> WeightsByTorqueNoise(const LoopRecords& records,
                                         std::span<const double> compliances_rad_per_Nm) {
  // Of the usual compliance: behind a reversal friction holds the gear, and the model is least sure of it.
  constexpr double kLeastCompliance = 0.5;
  std::vector<double> weights(compliances_rad_per_Nm.begin(), compliances_rad_per_Nm.end());
  const std::vector<std::size_t>& starts = records.samples.starts;
  for (std::size_t r = 0; r + 1 < starts.size(); ++r) {
    const auto own = std::span(weights).subspan(starts[r], starts[r + 1] - starts[r]);
    const double torque_noise_Nm =
        RobustStandardDeviation(std::span(records.torque_noise_Nm).subspan(starts[r], own.size()));
    double sum = 0.0;
    for (double& weight : own) {
      const double compliance = std::max(weight, kLeastCompliance * records.compliance_rad_per_Nm());
      const double noise_rad = std::hypot(compliance * torque_noise_Nm, records.position_noise_rad);
      weight = noise_rad > 0.0 ? 1.0 / (noise_rad * noise_rad) : 1.0;
      sum += weight;
    }
    for (double& weight : own) weight *= static_cast<double>(own.size()) / sum;
  }
  return weights;
}

}  // namespace strainwave::analysis::diagnosis
