// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/puma_560.h"

#include <cmath>

#include "analysis/units.h"

namespace strainwave::analysis::model {
namespace {

constexpr double kQuarter_rad = kTwoPi / 4.0;

// At the motor's shaft.
struct MotorLosses {
  double viscous_Nms_per_rad;
  double coulomb_Nm;
};
constexpr MotorLosses kMotors[] = {{1.48e-3, 0.415},    {0.817e-3, 0.0985},  {1.38e-3, 0.1185},
                                   {71.2e-6, 14.05e-3}, {82.6e-6, 11.88e-3}, {36.7e-6, 7.23e-3}};

}  // namespace

std::vector<ArmLink> Puma560() {
  return {{0.0, 0.0, kQuarter_rad, 0.0, {0.0, 0.0, 0.0}, {0.0, 0.35, 0.0}, 200e-6, -62.6111},
          {0.0, 0.4318, 0.0, 17.4, {-0.3638, 0.006, 0.2275}, {0.13, 0.524, 0.539}, 200e-6, 107.815},
          {0.15005,
           0.0203,
           -kQuarter_rad,
           4.8,
           {-0.0203, -0.0141, 0.070},
           {0.066, 0.086, 0.0125},
           200e-6,
           -53.7063},
          {0.4318, 0.0, kQuarter_rad, 0.82, {0.0, 0.019, 0.0}, {1.8e-3, 1.3e-3, 1.8e-3}, 33e-6, 76.0364},
          {0.0, 0.0, -kQuarter_rad, 0.34, {0.0, 0.0, 0.0}, {0.3e-3, 0.4e-3, 0.3e-3}, 33e-6, 71.923},
          {0.0, 0.0, 0.0, 0.09, {0.0, 0.0, 0.032}, {0.15e-3, 0.15e-3, 0.04e-3}, 33e-6, 76.686}};
}

std::vector<JointFriction> Puma560Friction() {
  constexpr double kBreakaway = 1.3;
  std::vector<JointFriction> friction;
  const std::vector<ArmLink> links = Puma560();
  for (std::size_t i = 0; i < links.size(); ++i) {
    const double ratio = std::abs(links[i].ratio);
    const double coulomb_Nm = kMotors[i].coulomb_Nm * ratio;
    friction.push_back({.coulomb_Nm = coulomb_Nm,
                        .breakaway_Nm = kBreakaway * coulomb_Nm,
                        .viscous_Nms_per_rad = kMotors[i].viscous_Nms_per_rad * ratio * ratio});
  }
  return friction;
}

std::vector<double> Puma560PeakTorques_Nm() { return {97.6, 186.4, 89.4, 24.2, 20.1, 21.3}; }

}  // namespace strainwave::analysis::model
