// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/quantities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/quantities.h"
#include "analysis/torsional_stiffness.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {

std::string OfRecord(const std::string& name, std::size_t record) {
  return record == 0 ? name : fmt::format("{}_{}", name, record + 1);
}

std::vector<UserQuantity> QuantitiesOfLoops(const LoopRecords& records, const Eigen::VectorXd& predicted) {
  std::vector<UserQuantity> of_loops;
  const LoopGrid& samples = records.samples;
  const TestTorques torques{
      .t1_Nm = records.t1_Nm, .t2_Nm = records.t2_Nm, .t3_Nm = std::max(records.t3_Nm, 1.01 * records.t2_Nm)};
  for (std::size_t r = 0; r < samples.records(); ++r) {
    const std::size_t first = samples.starts[r];
    const std::size_t count = samples.starts[r + 1] - first;
    const auto measure = [&](const double* twist_rad) {
      return FitStiffnessBackbone({std::span(samples.time_s).subspan(first, count),
                                   std::span(samples.torque_Nm).subspan(first, count),
                                   {twist_rad + first, count}},
                                  torques);
    };
    const TorsionalStiffness seen = measure(records.measured_rad.data());
    const TorsionalStiffness simulated = measure(predicted.data());
    const auto add = [&](const Quantity& quantity, double there, double here) {
      if (std::isfinite(there) && std::isfinite(here))
        of_loops.push_back({OfRecord(std::string(quantity.name), r), there, here});
    };
    add(quantities::kK1, seen.k1_Nm_per_rad.value, simulated.k1_Nm_per_rad.value);
    add(quantities::kK2, seen.k2_Nm_per_rad.value, simulated.k2_Nm_per_rad.value);
    add(quantities::kK3, seen.k3_Nm_per_rad.value, simulated.k3_Nm_per_rad.value);
    add(quantities::kHysteresis, ArcminFromRad(seen.hysteresis_rad.value),
        ArcminFromRad(simulated.hysteresis_rad.value));
  }
  return of_loops;
}

}  // namespace strainwave::analysis::diagnosis
