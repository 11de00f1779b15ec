// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_sticking_test {
namespace {

constexpr double kInertia_kgm2 = 0.07;
constexpr double kCoulomb_Nm = 1.2;
constexpr double kViscous_Nms_per_rad = 0.25;
constexpr double kDuration_s = 40.0;

// An axis with dry friction that a servo drives to and fro, 0.2 Hz at first and 3 Hz in the end. Where it
// turns the friction holds it until the torque has grown, so that its acceleration jumps twice, between the
// samples.
MotionData Record(unsigned seed, double rate_Hz, bool with_velocity) {
  constexpr double kStep_s = 1e-5;
  constexpr double kBandwidth_rad_per_s = kTwoPi * 6.0;
  constexpr double kSpeed_rad_per_s = 2.0;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  double place = 0.0;
  double speed = 0.0;
  double wanted = 0.0;
  const auto steps = static_cast<std::size_t>(kDuration_s / kStep_s);
  const auto each = static_cast<std::size_t>(std::lround(1.0 / (rate_Hz * kStep_s)));
  for (std::size_t i = 0; i < steps; ++i) {
    const double time_s = static_cast<double>(i) * kStep_s;
    const double wanted_speed =
        kSpeed_rad_per_s * std::sin(kTwoPi * (0.2 + 1.4 * time_s / kDuration_s) * time_s);
    wanted += kStep_s * wanted_speed;
    const double torque = kInertia_kgm2 * kBandwidth_rad_per_s *
                          (kBandwidth_rad_per_s * (wanted - place) + 1.6 * (wanted_speed - speed));
    if (i % each == 0) {
      record.time_s.push_back(time_s);
      record.position.push_back(place + 1e-6 * normal(random));
      if (with_velocity) record.velocity.push_back(speed + 2e-4 * normal(random));
      record.torque.push_back(torque + 0.015 * normal(random));
    }
    const double push = torque - kViscous_Nms_per_rad * speed;
    const double free = speed + kStep_s * push / kInertia_kgm2;
    const double held = kStep_s * kCoulomb_Nm / kInertia_kgm2;
    const double next = free - std::clamp(free, -held, held);
    speed = next * speed < 0.0 ? 0.0 : next;  // it stops before it goes the other way
    place += kStep_s * speed;
  }
  return record;
}

TEST(MotionSticking, IsNobodysEffect) {
  for (const bool with_velocity : {false, true}) {
    for (const unsigned seed : {1U, 2U}) {
      for (const double rate_Hz : {100.0, 200.0}) {
        const Diagnosed clean = DiagnoseRecords(&MakeMotionStudy, {Record(seed, rate_Hz, with_velocity)});
        EXPECT_EQ(clean.names(), Names()) << seed << " at " << rate_Hz << " Hz, velocity " << with_velocity;
        EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect);
      }
    }
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_sticking_test
