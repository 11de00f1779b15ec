// SPDX-License-Identifier: Apache-2.0
#include <ceres/tiny_solver.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "analysis/linear_regression.h"
#include "analysis/prepared_loop.h"
#include "analysis/stiffness_curve.h"
#include "analysis/stiffness_start.h"
#include "analysis/torsional_stiffness.h"

namespace strainwave::analysis {
namespace {

// ln W far below any torque that could be measured: the element is there, and does nothing.
constexpr double kNoFriction = -60.0;

struct Solution {
  StiffnessParameters parameters;
  double cost{std::numeric_limits<double>::infinity()};
};

Solution Solve(const StiffnessCurve& curve, const StiffnessParameters& start, int max_iterations) {
  ceres::TinySolver<StiffnessCurve> solver;
  solver.options.max_num_iterations = max_iterations;
  Solution solution{start};
  Eigen::VectorXd residuals(curve.NumResiduals());
  curve(start.data(), residuals.data(), nullptr);
  // Relative to where it starts: the solver's absolute defaults would stop a noise-free record early, and let
  // a noisy one wander among the kinks of its misfit.
  solver.options.function_tolerance = 1e-10 * residuals.squaredNorm();
  solver.options.gradient_tolerance = 1e-14;
  solver.options.parameter_tolerance = 1e-11;
  solver.options.cost_threshold = 0.0;
  solver.options.initial_trust_region_radius = 1e6;
  solver.Solve(curve, &solution.parameters);
  if (solution.parameters.allFinite()) {
    curve(solution.parameters.data(), residuals.data(), nullptr);
    solution.cost = residuals.squaredNorm();
  }
  return solution;
}

// Standard deviation of a reading, resolution included.
double Uncertainty(const NoiseLevel& noise) {
  return std::sqrt(noise.standard_deviation * noise.standard_deviation + noise.step * noise.step / 12.0);
}

struct Linearisation {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
};

Linearisation Linearise(const StiffnessCurve& curve, const StiffnessParameters& parameters) {
  const Eigen::Index n = curve.NumResiduals();
  Linearisation at{Eigen::VectorXd(n), Eigen::MatrixXd(n, static_cast<Eigen::Index>(kStiffnessParameters))};
  curve(parameters.data(), at.residuals.data(), at.jacobian.data());
  return at;
}

// Huber's weights, and none for a sample that was bridged. Returns false if no sample stands out.
bool WeighOutliers(const PreparedLoop& loop, const Eigen::VectorXd& residuals,
                   std::vector<double>* weight_root) {
  constexpr double kBend = 3.0;       // standard deviations up to which a sample has full weight
  constexpr double kStandsOut = 6.0;  // one beyond this makes the record one with outliers
  const double scale =
      RobustStandardDeviation({residuals.data(), static_cast<std::size_t>(residuals.size())});
  const bool outliers =
      residuals.cwiseAbs().maxCoeff() > std::max(kStandsOut * scale, 1e-6 * loop.torques.t3_Nm);
  if (!outliers && loop.spikes.empty()) {
    return false;
  }
  weight_root->assign(static_cast<std::size_t>(residuals.size()), 1.0);
  if (outliers && scale > 0.0) {
    for (std::size_t i = 0; i < weight_root->size(); ++i) {
      const double size = std::abs(residuals(static_cast<Eigen::Index>(i))) / scale;
      (*weight_root)[i] = size > kBend ? std::sqrt(kBend / size) : 1.0;
    }
  }
  for (std::size_t i : loop.spikes) {
    (*weight_root)[i] = 0.0;
  }
  return true;
}

// The misfit has kinks where a sample crosses a break and the element's first state a bound: a gradient may
// be left at the minimum. So convergence is judged by what further iterations would still change, in standard
// errors.
bool HasSettled(const StiffnessCurve& curve, const Solution& solution, const Eigen::MatrixXd& covariance) {
  constexpr double kStill = 0.05;
  const StiffnessParameters change = Solve(curve, solution.parameters, 8).parameters - solution.parameters;
  for (int k : {kLogK1, kLogK2, kLogK3}) {
    if (!(std::abs(change[k]) <= kStill * std::sqrt(std::max(0.0, covariance(k, k))) + 1e-8)) {
      return false;
    }
  }
  return true;
}

// Friction that yields in several steps leaves up to 0.17 of its torque (simulated: three elements of 0.9 to
// 3 Nm together that yield at 0.03 to 1 mrad); noise of lag-1 correlation 0.7, twice what neighbours
// tell. Knees of a gear of size 20 taken for one of size 14, 25 or 32 leave 0.21, 0.4 and 1.5 of the
// friction, 8 to 60 times the noise.
void CheckResidual(const Eigen::VectorXd& residuals, const TestTorques& torques, TorsionalStiffness* result) {
  constexpr double kOfNoise = 8.0;
  constexpr double kOfFriction = 0.2;
  constexpr double kOfPeak = 1e-3;
  const double left_Nm =
      RobustStandardDeviation({residuals.data(), static_cast<std::size_t>(residuals.size())});
  if (left_Nm <= std::max({kOfNoise * result->noise_Nm, kOfFriction * result->friction_torque_Nm,
                           kOfPeak * torques.t3_Nm})) {
    return;
  }
  result->failed_checks.push_back(fmt::format(
      "the model leaves {:.2g} Nm of the torque, and the noise is {:.2g} Nm (expected at most {:g} "
      "times that: are t1 = {:g} and t2 = {:g} Nm the knees of this gear?)",
      left_Nm, result->noise_Nm, kOfNoise, torques.t1_Nm, torques.t2_Nm));
}

// Without a loop in the record nothing holds the element: its stiffness W/δ and the spring's could be shared
// out at will.
bool FrictionIsPoorlyHeld(const StiffnessCurve& curve, const StiffnessParameters& parameters) {
  const Linearisation at = Linearise(curve, parameters);
  const Eigen::MatrixXd covariance = SandwichCovariance(at.jacobian, at.residuals);
  return std::exp(parameters[kLogYieldTwist]) > 0.25 * curve.twist_scale_rad ||
         covariance(kLogFriction, kLogFriction) > 0.25 * 0.25;
}

// The element then stays only if it explains more than its three parameters would by chance.
Solution DropNeedlessFriction(const StiffnessCurve& curve, const Solution& with) {
  if (!FrictionIsPoorlyHeld(curve, with.parameters)) {
    return with;
  }
  StiffnessParameters start = with.parameters;
  start[kLogFriction] = kNoFriction;
  const Solution without = Solve(curve, start, 40);
  const double variance = with.cost / static_cast<double>(curve.NumResiduals());
  return without.cost - with.cost > 16.0 * variance ? with : without;
}

}  // namespace

TorsionalStiffness FitStiffnessModel(const TorsionLoop& raw, const TestTorques& torques) {
  const PreparedLoop loop = PrepareLoop(raw, torques);
  const LoopInputs inputs = MakeLoopInputs(loop);
  const auto [low, high] = std::minmax_element(loop.twist_rad.begin(), loop.twist_rad.end());
  const auto [low_Nm, high_Nm] = std::minmax_element(loop.torque_Nm.begin(), loop.torque_Nm.end());
  const double twist_range_rad = std::max(*high - *low, 1e-12);
  const double mean_slope_Nm_per_rad = (*high_Nm - *low_Nm) / twist_range_rad;
  const double twist_noise_Nm = Uncertainty(loop.twist_noise_rad) * mean_slope_Nm_per_rad;
  const bool torque_is_cleaner = twist_noise_Nm > Uncertainty(loop.torque_noise_Nm);

  StiffnessCurve curve{.torque_Nm = loop.torque_Nm,
                       .twist_rad = loop.twist_rad,
                       .monotone_input = torque_is_cleaner ? inputs.torque_Nm : inputs.twist_rad,
                       .weight_root = {},
                       .torques = torques,
                       .twist_scale_rad = twist_range_rad,
                       .torque_per_twist_Nm_per_rad = mean_slope_Nm_per_rad,
                       .drive = torque_is_cleaner ? LoopDrive::kTorque : LoopDrive::kTwist};

  // Several starts on a thinned record, the best one on the whole.
  const ThinnedLoop thinned = ThinLoop(loop, inputs);
  StiffnessCurve thinned_curve = curve;
  thinned_curve.torque_Nm = thinned.torque_Nm;
  thinned_curve.twist_rad = thinned.twist_rad;
  thinned_curve.monotone_input = torque_is_cleaner ? thinned.torque_input_Nm : thinned.twist_input_rad;
  Solution best;
  for (const StiffnessParameters& start : StiffnessStarts(loop, thinned, twist_range_rad)) {
    const Solution candidate = Solve(thinned_curve, start, 40);
    if (candidate.cost < best.cost) {
      best = candidate;
    }
  }
  best = DropNeedlessFriction(curve, Solve(curve, best.parameters, 40));

  std::vector<double> weight_root;
  Linearisation at = Linearise(curve, best.parameters);
  for (int round = 0; round < 4 && WeighOutliers(loop, at.residuals, &weight_root); ++round) {
    curve.weight_root = weight_root;
    best = Solve(curve, best.parameters, 30);
    curve.weight_root = {};
    at = Linearise(curve, best.parameters);
  }

  TorsionalStiffness result;
  const bool has_friction = std::exp(best.parameters[kLogFriction]) > 1e-9 * torques.t1_Nm;
  if (has_friction) {
    result.friction_torque_Nm = std::exp(best.parameters[kLogFriction]);
    result.yield_twist_rad = std::exp(best.parameters[kLogYieldTwist]);
  }
  result.fitted_torque_Nm = curve.TorqueAtTwist(best.parameters, inputs.twist_rad);
  result.rms_residual_Nm = std::sqrt(at.residuals.squaredNorm() / static_cast<double>(at.residuals.size()));
  result.noise_Nm = std::hypot(twist_noise_Nm, Uncertainty(loop.torque_noise_Nm));

  curve.weight_root = weight_root;
  at = Linearise(curve, best.parameters);
  if (!has_friction) {
    // What is not in the model costs the slopes no certainty.
    at.jacobian.col(kLogFriction).setZero();
    at.jacobian.col(kLogYieldTwist).setZero();
    at.jacobian.col(kStartShare).setZero();
  }
  const Eigen::MatrixXd covariance = SandwichCovariance(at.jacobian, at.residuals);
  Estimate* slopes[3] = {&result.k1_Nm_per_rad, &result.k2_Nm_per_rad, &result.k3_Nm_per_rad};
  for (int k = 0; k < 3; ++k) {
    const double value = std::exp(best.parameters[k]);
    // A segment that no sample reaches leaves its column empty.
    const bool seen = at.jacobian.col(k).squaredNorm() > 0.0;
    *slopes[k] = seen ? Estimate{value, value * std::sqrt(std::max(0.0, covariance(k, k)))} : kNotEstimated;
  }

  MeasureLoopWidth(loop, &result);
  CheckResidual(at.residuals, torques, &result);
  if (!HasSettled(curve, best, covariance)) {
    result.failed_checks.push_back("fit not converged");
  }
  CheckLoop(loop, &result);
  return result;
}

}  // namespace strainwave::analysis
