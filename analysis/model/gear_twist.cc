// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/gear_twist.h"

#include <cmath>
#include <limits>

namespace strainwave::analysis::model {
namespace {

// Far below anything the sensors resolve, far above rounding.
constexpr double kTorqueTolerance_Nm = 1e-10;
constexpr double kTwistTolerance_rad = 1e-14;
constexpr int kMostSteps = 60;  // a bisection of the whole range ends long before

struct Residual {
  double value;
  double slope;
};

// Finds the zero of a strictly rising, piecewise-linear function. A Newton step that would leave the bracket
// (it may cycle between two pieces) is replaced by halving the bracket. What is returned is the last place at
// which the function was evaluated.
template <typename Function>
double RisingZero(const Function& function, double start, double tolerance) noexcept {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  double x = start;
  for (int step = 0; step < kMostSteps; ++step) {
    const Residual residual = function(x);
    if (std::abs(residual.value) < tolerance) return x;
    (residual.value > 0.0 ? high : low) = x;
    double next = x - residual.value / residual.slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - x) < kTwistTolerance_rad) return x;
    x = next;
  }
  return x;
}

}  // namespace

TwistSolution SolveTwist(const TwistCurve& curve, double scale, double anchor_rad, const OutputGrip& grip,
                         double no_load_output_rad, double load_torque_Nm, double start_twist_rad) noexcept {
  const double compliance = curve.series_compliance_rad_per_Nm;
  const double grip_stiffness = grip.stiffness_Nm_per_rad;
  SpringState gear{};
  const auto residual = [&](double twist_rad) noexcept -> Residual {
    gear = GearTorque(curve, scale, anchor_rad, twist_rad);
    const double output_rad = no_load_output_rad + twist_rad + compliance * gear.torque_Nm;
    const double stuck_Nm = (output_rad - grip.anchor_rad) * grip_stiffness;
    const double limit = grip.element.limit_Nm;
    if (stuck_Nm > limit) return {gear.torque_Nm - load_torque_Nm + limit, gear.stiffness_Nm_per_rad};
    if (stuck_Nm < -limit) return {gear.torque_Nm - load_torque_Nm - limit, gear.stiffness_Nm_per_rad};
    return {gear.torque_Nm - load_torque_Nm + stuck_Nm,
            gear.stiffness_Nm_per_rad + grip_stiffness * (1.0 + compliance * gear.stiffness_Nm_per_rad)};
  };
  const double twist_rad = RisingZero(residual, start_twist_rad, kTorqueTolerance_Nm);
  return {twist_rad, gear.torque_Nm, no_load_output_rad + twist_rad + compliance * gear.torque_Nm};
}

TwistSolution SolveTwistAtDeflection(const TwistCurve& curve, double scale, double anchor_rad,
                                     double deflection_rad, double start_twist_rad) noexcept {
  const double compliance = curve.series_compliance_rad_per_Nm;
  if (compliance == 0.0) {
    return {deflection_rad, GearTorque(curve, scale, anchor_rad, deflection_rad).torque_Nm, deflection_rad};
  }
  SpringState gear{};
  const auto residual = [&](double twist_rad) noexcept -> Residual {
    gear = GearTorque(curve, scale, anchor_rad, twist_rad);
    return {twist_rad + compliance * gear.torque_Nm - deflection_rad,
            1.0 + compliance * gear.stiffness_Nm_per_rad};
  };
  const double twist_rad = RisingZero(residual, start_twist_rad, kTwistTolerance_rad);
  return {twist_rad, gear.torque_Nm, deflection_rad};
}

}  // namespace strainwave::analysis::model
