// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kGap_rad = 0.02;
constexpr double kMotorInertia_kgm2 = 0.03;
constexpr double kLoadInertia_kgm2 = 0.04;

// A servo drives a motor to and fro, 0.3 Hz at first and 4 Hz in the end. Behind a gap and a stiff shaft (75
// Hz of the load on it) there is a load without friction of its own, in the middle of the gap at first. Both
// are free: where the gap closes the motor is thrown back.
MotionData Record(unsigned seed) {
  constexpr double kStep_s = 1e-5;
  constexpr int kEach = 100;
  constexpr double kBandwidth_rad_per_s = kTwoPi * 6.0;
  constexpr double kCoulomb_Nm = 0.4;
  constexpr double kViscous_Nms_per_rad = 0.05;
  constexpr double kDuration_s = 5.0;
  const double stiffness_Nm = kLoadInertia_kgm2 * std::pow(kTwoPi * 75.0, 2);
  const double damping_Nms = 0.4 * kLoadInertia_kgm2 * kTwoPi * 75.0;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  double place = 0.0, speed = 0.0, load = 0.0, load_speed = 0.0, wanted = 0.0;
  for (int i = 0; i * kStep_s < kDuration_s; ++i) {
    const double time_s = i * kStep_s;
    const double phase = kTwoPi * (0.3 + 1.85 * time_s / kDuration_s) * time_s;
    const double wanted_speed = 2.0 * std::sin(phase);
    wanted += kStep_s * wanted_speed;
    const double torque = (kMotorInertia_kgm2 + kLoadInertia_kgm2) * kBandwidth_rad_per_s *
                          (kBandwidth_rad_per_s * (wanted - place) + 1.6 * (wanted_speed - speed));
    if (i % kEach == 0) {
      record.time_s.push_back(time_s);
      record.position.push_back(place + 1e-7 * normal(random));
      record.torque.push_back(torque + 0.6 * normal(random));
    }
    const double lead = place - load;
    const double into = std::abs(lead) - 0.5 * kGap_rad;
    const double sense = std::copysign(1.0, lead);
    const double contact_Nm =
        into > 0.0 ? sense * std::max(0.0, stiffness_Nm * into + sense * damping_Nms * (speed - load_speed))
                   : 0.0;
    const double free =
        speed + kStep_s * (torque - contact_Nm - kViscous_Nms_per_rad * speed) / kMotorInertia_kgm2;
    const double held = kStep_s * kCoulomb_Nm / kMotorInertia_kgm2;
    speed = free - std::clamp(free, -held, held);
    place += kStep_s * speed;
    load_speed += kStep_s * contact_Nm / kLoadInertia_kgm2;
    load += kStep_s * load_speed;
  }
  return record;
}

TEST(MotionBacklash, IsNamedBehindAStiffShaftThatThrowsTheMotorBack) {
  for (const unsigned seed : {1U, 2U}) {
    const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {Record(seed)});
    EXPECT_EQ(found.names(), Names{"backlash"}) << seed;
    EXPECT_NEAR(found.value("backlash_rad").value, kGap_rad, 0.2 * kGap_rad) << seed;
    EXPECT_NEAR(found.value("load_inertia_kgm2").value, kLoadInertia_kgm2, 0.2 * kLoadInertia_kgm2) << seed;
  }
}

// Where in its gap the load is at first is a state of the record: in full each of the six numbers of the gap
// would be charged.
TEST(MotionBacklash, IsHardlyChargedForWhereTheLoadBegins) {
  const MotionData record = Record(1);
  const std::unique_ptr<Study> study = MakeMotionStudy({&record, 1});
  const auto& causes = study->causes();
  const auto cause = std::ranges::find(causes, "backlash", &CauseRule::name) - causes.begin();
  const std::vector<double> ones(study->measured().size(), 1.0);
  const std::vector<std::size_t> only{static_cast<std::size_t>(cause)};
  const ModelFit fit = study->Fit(only, ones, nullptr, FitPurpose::kCompare);
  EXPECT_GT(fit.known_before, 0.3);
  EXPECT_LT(fit.known_before, 1.0);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis
