// SPDX-License-Identifier: Apache-2.0
#include "analysis/torsional_stiffness.h"

#include <array>
#include <cmath>
#include <utility>

#include "analysis/arguments.h"

namespace strainwave::analysis {
namespace {

TorsionalStiffness Fit(const TorsionLoop& loop, const TestTorques& torques, StiffnessMethod method) {
  switch (method) {
    case StiffnessMethod::kModel:
      return FitStiffnessModel(loop, torques);
    case StiffnessMethod::kLoading:
      return FitStiffnessLoading(loop, torques);
    case StiffnessMethod::kBackbone:
      return FitStiffnessBackbone(loop, torques);
  }
  throw std::invalid_argument(fmt::format("method = {} is none of the three", static_cast<int>(method)));
}

TorsionalStiffness FitWithout(const TorsionLoop& loop, const TestTorques& torques, StiffnessMethod method,
                              double compliance_rad_per_Nm) {
  if (compliance_rad_per_Nm == 0.0) {
    return Fit(loop, torques, method);
  }
  std::vector<double> gear_twist_rad(loop.twist_rad.begin(), loop.twist_rad.end());
  for (std::size_t i = 0; i < gear_twist_rad.size(); ++i) {
    gear_twist_rad[i] -= compliance_rad_per_Nm * loop.torque_Nm[i];
  }
  return Fit({loop.time_s, loop.torque_Nm, gear_twist_rad}, torques, method);
}

std::array<Estimate*, 3> Slopes(TorsionalStiffness& result) {
  return {&result.k1_Nm_per_rad, &result.k2_Nm_per_rad, &result.k3_Nm_per_rad};
}

void AddInQuadrature(Estimate* estimate, double error) {
  estimate->standard_error = std::hypot(estimate->standard_error, error);
}

}  // namespace

TorsionalStiffness MeasureStiffness(const TorsionLoop& loop, const TestTorques& torques,
                                    StiffnessMethod method, const SeriesCompliance& bench,
                                    double torque_gain_relative_se) {
  const Estimate& compliance = bench.compliance_rad_per_Nm;
  RequireNotNegative("compliance_rad_per_Nm", compliance.value);
  RequireNotNegative("compliance_rad_per_Nm.standard_error", compliance.standard_error);
  RequireNotNegative("torque_gain_relative_se", torque_gain_relative_se);
  RequireSameLength("torque_Nm", loop.torque_Nm, "twist_rad", loop.twist_rad);

  TorsionalStiffness result = FitWithout(loop, torques, method, compliance.value);
  if (compliance.standard_error > 0.0) {
    TorsionalStiffness moved =
        FitWithout(loop, torques, method, compliance.value + compliance.standard_error);
    const auto here = Slopes(result);
    const auto there = Slopes(moved);
    for (std::size_t k = 0; k < here.size(); ++k) {
      AddInQuadrature(here[k], there[k]->value - here[k]->value);
    }
    AddInQuadrature(&result.lost_motion_rad, moved.lost_motion_rad.value - result.lost_motion_rad.value);
  }
  for (Estimate* slope : Slopes(result)) {
    AddInQuadrature(slope, torque_gain_relative_se * slope->value);
  }
  return result;
}

}  // namespace strainwave::analysis
