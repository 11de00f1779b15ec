// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/quantities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "analysis/quantities.h"
#include "analysis/torsional_stiffness.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

TorsionalStiffness StiffnessOfRecord(const LoopRecords& records, std::size_t record,
                                     const double* twist_rad) {
  const LoopGrid& samples = records.samples;
  const TestTorques torques{
      .t1_Nm = records.t1_Nm, .t2_Nm = records.t2_Nm, .t3_Nm = std::max(records.t3_Nm, 1.01 * records.t2_Nm)};
  const std::size_t first = samples.starts[record];
  const std::size_t count = samples.starts[record + 1] - first;
  return FitStiffnessBackbone({std::span(samples.time_s).subspan(first, count),
                               std::span(samples.torque_Nm).subspan(first, count),
                               {twist_rad + first, count}},
                              torques);
}

}  // namespace

std::string OfRecord(const std::string& name, std::size_t record) {
  return record == 0 ? name : fmt::format("{}_{}", name, record + 1);
}

std::vector<UserQuantity> QuantitiesOfLoops(const LoopRecords& records, const Eigen::VectorXd& predicted) {
  std::vector<UserQuantity> of_loops;
  for (std::size_t r = 0; r < records.samples.records(); ++r) {
    const TorsionalStiffness seen = StiffnessOfRecord(records, r, records.measured_rad.data());
    const TorsionalStiffness simulated = StiffnessOfRecord(records, r, predicted.data());
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

std::string DifferentStiffnesses(const LoopRecords& records) {
  if (records.samples.records() < 2) return {};
  constexpr double kBeyondErrors = 5.0;  // standard errors of the difference
  constexpr double kLeastShare = 0.01;   // of K2: less moves no number that people use
  std::vector<Estimate> all;             // K2: the one that every loop holds most of
  for (std::size_t r = 0; r < records.samples.records(); ++r)
    all.push_back(StiffnessOfRecord(records, r, records.measured_rad.data()).k2_Nm_per_rad);
  std::erase_if(all,
                [](const Estimate& one) { return !(one.value > 0.0) || !std::isfinite(one.standard_error); });
  if (all.size() < 2) return {};
  const auto [low, high] = std::ranges::minmax(all, {}, &Estimate::value);
  const double apart = high.value - low.value;
  if (apart < kBeyondErrors * std::hypot(low.standard_error, high.standard_error) ||
      apart < kLeastShare * high.value)
    return {};
  return fmt::format(
      "the records differ in stiffness, K2 from {:.0f} ± {:.0f} to {:.0f} ± {:.0f} Nm/rad, and one "
      "simulation with one stiffness explains none of them: it depends on the angle at which the input is "
      "locked "
      "(position_dependent_stiffness, average over 0, 45 and 90 deg), or they are of other gears, "
      "temperatures or ages (each by itself shows what is missing in it)",
      low.value, low.standard_error, high.value, high.standard_error);
}

}  // namespace strainwave::analysis::diagnosis
