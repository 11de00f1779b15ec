// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/torque_noise.h"

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::diagnosis {

Eigen::VectorXd ResponseToTorqueNoise(const LoopRecords& records, const Eigen::VectorXd& gear_rad) {
  const LoopGrid& samples = records.samples;
  const double usual = records.compliance_rad_per_Nm();
  double compliance_rad_per_Nm = usual;
  Eigen::VectorXd response_rad(gear_rad.size());
  for (Eigen::Index i = 0; i < gear_rad.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (i > 0 && samples.torque_Nm[k] != samples.torque_Nm[k - 1] && std::isnan(samples.turn_Nm[k])) {
      const double slope =
          (gear_rad(i) - gear_rad(i - 1)) / (samples.torque_Nm[k] - samples.torque_Nm[k - 1]);
      compliance_rad_per_Nm = std::clamp(slope, 0.0, 3.0 * usual);
    }
    response_rad(i) = compliance_rad_per_Nm * records.torque_noise_Nm[k];
  }
  return response_rad;
}

}  // namespace strainwave::analysis::diagnosis
