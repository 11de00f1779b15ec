// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/rigid_arm.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "analysis/model/joint_losses.h"
#include "analysis/model/puma_560.h"
#include "analysis/units.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::model::model_rigid_arm_test {
namespace {

using Joints = std::array<double, 6>;

// The pose qn of docs/sources.md#corke-2017, of which it prints gravity loads and inertia.
constexpr Joints kNominal_rad{0.0, kPi / 4.0, kPi, 0.0, kPi / 4.0, 0.0};
constexpr Joints kStill{};

TEST(RigidArm, HoldsThePuma560AgainstGravityAsPublished) {
  const std::vector<double> torques_Nm = InverseDynamics_Nm(Puma560(), kNominal_rad, kStill, kStill);
  const Joints published_Nm{0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0};
  constexpr double kPrinted_Nm = 6e-5;  // its last digit
  for (std::size_t j = 0; j < published_Nm.size(); ++j)
    EXPECT_NEAR(torques_Nm[j], published_Nm[j], kPrinted_Nm) << j;
  // The arm extended.
  const Joints extended_rad{0.0, 0.0, -kPi / 2.0, 0.0, 0.0, 0.0};
  EXPECT_NEAR(InverseDynamics_Nm(Puma560(), extended_rad, kStill, kStill)[1], 46.0069, kPrinted_Nm);
}

TEST(RigidArm, HasTheInertiaOfThePuma560AsPublished) {
  // Column j: the torques of a unit acceleration of joint j, without gravity.
  const double published_kgm2[6][6] = {
      {3.6594, -0.4044, 0.1006, -0.0025, 0.0, 0.0}, {-0.4044, 4.4137, 0.3509, 0.0, 0.0024, 0.0},
      {0.1006, 0.3509, 0.9378, 0.0, 0.0015, 0.0},   {-0.0025, 0.0, 0.0, 0.1925, 0.0, 0.0},
      {0.0, 0.0024, 0.0015, 0.0, 0.1713, 0.0},      {0.0, 0.0, 0.0, 0.0, 0.0, 0.1941}};
  constexpr double kPrinted_kgm2 = 6e-5;
  for (std::size_t j = 0; j < 6; ++j) {
    Joints acceleration{};
    acceleration[j] = 1.0;
    const std::vector<double> column = InverseDynamics_Nm(Puma560(), kNominal_rad, kStill, acceleration, 0.0);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(column[i], published_kgm2[i][j], kPrinted_kgm2) << i << ", " << j;
  }
}

TEST(RigidArm, MovesTwoPointMassesInAPlaneAsTheTextbookSays) {
  // Lagrange's equations of a planar arm of two point masses at the ends of its links, z of the base
  // horizontal: here the plane is turned by the twist of a first link that does not move.
  constexpr double kLength_m[2] = {0.7, 0.4};
  constexpr double kMass_kg[2] = {3.0, 1.5};
  const std::vector<ArmLink> links{{.twist_rad = kPi / 2.0},
                                   {.length_m = kLength_m[0], .mass_kg = kMass_kg[0]},
                                   {.length_m = kLength_m[1], .mass_kg = kMass_kg[1]}};
  const double q1 = 0.4, q2 = -1.1, w1 = 0.9, w2 = -1.7, a1 = 2.0, a2 = 0.6;
  const std::array<double, 3> q{0.0, q1, q2}, qd{0.0, w1, w2}, qdd{0.0, a1, a2};
  const double l1 = kLength_m[0], l2 = kLength_m[1], m1 = kMass_kg[0], m2 = kMass_kg[1], g = 9.81;
  const double c2 = std::cos(q2), s2 = std::sin(q2);
  const double tau1 = ((m1 + m2) * l1 * l1 + m2 * l2 * l2 + 2 * m2 * l1 * l2 * c2) * a1 +
                      (m2 * l2 * l2 + m2 * l1 * l2 * c2) * a2 - m2 * l1 * l2 * s2 * (2 * w1 * w2 + w2 * w2) +
                      (m1 + m2) * g * l1 * std::cos(q1) + m2 * g * l2 * std::cos(q1 + q2);
  const double tau2 = (m2 * l2 * l2 + m2 * l1 * l2 * c2) * a1 + m2 * l2 * l2 * a2 +
                      m2 * l1 * l2 * s2 * w1 * w1 + m2 * g * l2 * std::cos(q1 + q2);
  const std::vector<double> torques_Nm = InverseDynamics_Nm(links, q, qd, qdd);
  EXPECT_NEAR(torques_Nm[1], tau1, 1e-12 * std::abs(tau1));
  EXPECT_NEAR(torques_Nm[2], tau2, 1e-12 * std::abs(tau1));
}

TEST(RigidArm, CarriesAPayloadAsASecondLinkThatIsFixedToTheHand) {
  // The same as one more link whose joint does not move.
  std::vector<ArmLink> longer = Puma560();
  longer.push_back({.mass_kg = 2.0, .centre_m = {0.0, 0.0, 0.15}});
  const Joints q{0.3, 0.8, -1.4, 0.5, -0.7, 1.1}, qd{0.4, -0.2, 0.7, 1.1, -0.9, 0.6},
      qdd{1.0, 2.0, -3.0, 0.4, 0.2, 5.0};
  std::vector<double> q7(q.begin(), q.end()), qd7(qd.begin(), qd.end()), qdd7(qdd.begin(), qdd.end());
  for (std::vector<double>* values : {&q7, &qd7, &qdd7}) values->push_back(0.0);
  const std::vector<double> expected_Nm = InverseDynamics_Nm(longer, q7, qd7, qdd7);
  const std::vector<double> torques_Nm = InverseDynamics_Nm(WithPayload(Puma560(), 2.0, 0.15), q, qd, qdd);
  for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(torques_Nm[j], expected_Nm[j], 1e-10) << j;
}

TEST(RigidArm, RefusesOtherNumbersOfJoints) {
  const std::array<double, 2> two{};
  EXPECT_EQ(MessageOf([&] { InverseDynamics_Nm(Puma560(), two, two, two); }),
            "positions, velocities and accelerations differ in number from the links");
  EXPECT_EQ(MessageOf([] { WithPayload({}, 1.0, 0.1); }), "a payload needs a link and a mass from 0 up");
}

TEST(JointLosses, FollowTheStribeckCurve) {
  const JointFriction friction{
      .coulomb_Nm = 2.0, .breakaway_Nm = 3.0, .stribeck_rad_per_s = 0.1, .viscous_Nms_per_rad = 5.0};
  // Near standstill, at the Stribeck speed by hand, and far above it.
  EXPECT_NEAR(FrictionTorque_Nm(friction, 0.01), 2.0 + std::exp(-0.01) + 0.05, 1e-3);
  EXPECT_NEAR(FrictionTorque_Nm(friction, 0.1), 2.0 + std::exp(-1.0) + 0.5, 1e-9);
  EXPECT_NEAR(FrictionTorque_Nm(friction, -2.0), -12.0, 1e-9);
  EXPECT_EQ(FrictionTorque_Nm(friction, 0.0), 0.0);
  EXPECT_NEAR(BrakeDrag_Nm(4.0, -1.0), -4.0, 1e-12);
  const ReducerWear wear{.friction_share = 0.5, .ripple_share = 0.2, .teeth_per_turn = 4.0, .phase_rad = 0.0};
  EXPECT_NEAR(WearTorque_Nm(wear, 10.0, kPi / 8.0), 7.0, 1e-12);
}

}  // namespace
}  // namespace strainwave::analysis::model::model_rigid_arm_test
