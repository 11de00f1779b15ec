// SPDX-License-Identifier: Apache-2.0
#include "analysis/torsional_stiffness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "analysis/arguments.h"

namespace strainwave::analysis {
namespace {

std::array<Estimate*, 3> Slopes(TorsionalStiffness& result) {
  return {&result.k1_Nm_per_rad, &result.k2_Nm_per_rad, &result.k3_Nm_per_rad};
}

void AddInQuadrature(Estimate* estimate, double error) {
  estimate->standard_error = std::hypot(estimate->standard_error, error);
}

// The mid-line knows nothing of how friction yields, the model has one element for it: by how much the two
// part is what that form costs. Simulated loops to 34 Nm whose friction of 0.6 to 1.7 Nm yields in three
// steps (0.03 to 1 mrad, noise 0.03 Nm): the model's slopes are off by 0.7 to 5.7 % at worst, 0.6 to 1.6
// times the largest relative difference of any slope, which therefore stands for all three; one element: the
// two agree within 1.4 of their errors.
void AddMisfitOfForm(TorsionalStiffness backbone, TorsionalStiffness* model) {
  constexpr double kAgree = 2.0;  // errors of the two together
  const auto by_model = Slopes(*model);
  const auto by_line = Slopes(backbone);
  bool parted = false;
  double largest = 0.0;
  for (std::size_t k = 0; k < by_model.size(); ++k) {
    const double apart = std::abs(by_model[k]->value - by_line[k]->value);
    const double errors = std::hypot(by_model[k]->standard_error, by_line[k]->standard_error);
    const double rounding = 1e-6 * by_model[k]->value;
    largest = std::max(largest, apart / by_model[k]->value);
    if (!(apart > kAgree * errors + rounding)) continue;
    parted = true;
    model->warnings.push_back(fmt::format(
        "K{} is {:.0f} ± {:.0f} Nm/rad by the model, {:.0f} ± {:.0f} by the backbone: they differ by more "
        "than their errors (friction that does not yield all at once, or other knees)",
        k + 1, by_model[k]->value, by_model[k]->standard_error, by_line[k]->value,
        by_line[k]->standard_error));
  }
  // A mid-line with a segment missing, or with friction that still sticks, is no witness.
  const bool is_whole =
      std::ranges::all_of(by_line, [](const Estimate* slope) { return std::isfinite(slope->value); });
  if (!parted || !is_whole || !backbone.failed_checks.empty()) return;
  for (Estimate* slope : by_model) AddInQuadrature(slope, largest * slope->value);
}

TorsionalStiffness Fit(const TorsionLoop& loop, const TestTorques& torques, StiffnessMethod method) {
  switch (method) {
    case StiffnessMethod::kModel: {
      TorsionalStiffness model = FitStiffnessModel(loop, torques);
      AddMisfitOfForm(FitStiffnessBackbone(loop, torques), &model);
      return model;
    }
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

}  // namespace

std::string_view NameOf(StiffnessMethod method) {
  switch (method) {
    case StiffnessMethod::kModel:
      return "model";
    case StiffnessMethod::kLoading:
      return "loading";
    case StiffnessMethod::kBackbone:
      return "backbone";
  }
  return {};
}

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
