// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/regressors.h"

#include <utility>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {

std::vector<Regressor> RegressorsOf(const LoopRecords& records) {
  const LoopGrid& samples = records.samples;
  std::vector<double> output_angle_rad(samples.position_rad);
  for (std::size_t r = 0; r < samples.records(); ++r) {
    for (std::size_t i = samples.starts[r]; i < samples.starts[r + 1]; ++i)
      output_angle_rad[i] += records.centre_rad[r];
  }
  std::vector<Regressor> regressors;
  regressors.push_back({"torque", "torque / Nm", 1.0, samples.torque_Nm, false});
  regressors.push_back({"torque_rate", "torque rate / (Nm/s)", 1.0, records.torque_rate_Nm_per_s, false});
  regressors.push_back(
      {"output_angle", "output angle / deg", DegFromRad(1.0), std::move(output_angle_rad), true});
  regressors.push_back({"time", "time / s", 1.0, samples.time_s, false});
  regressors.push_back({"direction", "direction of the torque", 1.0, samples.direction, false});
  if (!samples.temperature_K.empty()) {
    regressors.push_back({"temperature", "temperature from its mean / K", 1.0, samples.temperature_K, false});
  }
  return regressors;
}

}  // namespace strainwave::analysis::diagnosis
