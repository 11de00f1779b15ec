// SPDX-License-Identifier: Apache-2.0
// Friction that bends before it slides (docs/effects.md E12) belongs to the nominal axis and is no effect.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_presliding_test {
namespace {

constexpr double kInertia_kgm2 = 0.05;
constexpr double kViscous_Nms_per_rad = 0.08;
constexpr double kCoulomb_Nm = 0.6;
constexpr double kNoise_Nm = 0.01;
constexpr double kMove_s = 0.8;
constexpr double kDwell_s = 0.4;
constexpr double kAmplitude_rad = 0.5;

// Moves to and fro between rests, each of them a fifth-order polynomial.
double Wanted(double time_s) {
  const double period_s = kMove_s + kDwell_s;
  const double moves = std::floor(time_s / period_s);
  const double u = std::min(1.0, std::max(0.0, (time_s - moves * period_s - kDwell_s) / kMove_s));
  const double share = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
  return kAmplitude_rad * (std::fmod(moves, 2.0) == 0.0 ? share : 1.0 - share);
}

// An axis under PD control with the inertia's torque fed forward, whose friction is Dahl's: a bend z of −1 to
// 1, dz/dq = (1 − z sign v) / way. It begins with the friction that the motion before has left.
MotionData Record(unsigned seed, double way_rad, double first_bend) {
  constexpr double kStep_s = 1e-5;
  constexpr std::size_t kEach = 400;  // 250 Hz
  constexpr double kBandwidth_rad_per_s = kTwoPi * 12.0;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  double position = 0.0;
  double speed = 0.0;
  double bend = first_bend;
  for (std::size_t i = 0; i < static_cast<std::size_t>(16.0 / kStep_s); ++i) {
    const double time_s = static_cast<double>(i) * kStep_s;
    const auto wanted = [&](int k) { return Wanted(time_s + 1e-3 * k); };
    const double wanted_speed = (wanted(1) - wanted(-1)) / 2e-3;
    const double wanted_acceleration = (wanted(1) - 2.0 * wanted(0) + wanted(-1)) / 1e-6;
    const double torque =
        kInertia_kgm2 *
        (wanted_acceleration + kBandwidth_rad_per_s * (kBandwidth_rad_per_s * (wanted(0) - position) +
                                                       1.6 * (wanted_speed - speed)));
    if (i % kEach == 0) {
      record.time_s.push_back(time_s);
      record.position.push_back(position + 2e-6 * normal(random));
      record.torque.push_back(torque + kNoise_Nm * normal(random));
    }
    speed += kStep_s / kInertia_kgm2 * (torque - kViscous_Nms_per_rad * speed - kCoulomb_Nm * bend);
    const double moved = kStep_s * speed;
    const double end = std::copysign(1.0, moved);
    bend = end - (end - bend) * std::exp(-std::abs(moved) / way_rad);
    position += moved;
  }
  return record;
}

TEST(MotionPresliding, IsNoEffectAndLeavesTheNumbersRight) {
  for (const double way_rad : {3e-4, 2e-3}) {
    for (const double first_bend : {0.0, -0.8}) {
      const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {Record(5, way_rad, first_bend)});
      EXPECT_EQ(found.names(), Names()) << way_rad << " " << first_bend;
      EXPECT_EQ(found.diagnosis.verdict, Verdict::kNoEffect) << way_rad << " " << first_bend;
      EXPECT_NEAR(found.nominal("coulomb_Nm").value, kCoulomb_Nm, 0.02 * kCoulomb_Nm) << way_rad;
      EXPECT_NEAR(found.nominal("inertia_kgm2").value, kInertia_kgm2, 0.01 * kInertia_kgm2) << way_rad;
    }
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_presliding_test
