// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/led_axis.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_backlash_test {
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

// An axis that is led along its way, with a light load in a gap that strikes for half a sample of a slow
// logger, and as many samples that stand off by chance as there are.
MotionData SlowlyLogged(unsigned seed, double load_kgm2, int spikes, double begin = 1.0) {
  constexpr double kNoise_Nm = 0.05;
  MotionData record = RecordOf({.path = {{1.0, kTwoPi * 0.21}, {0.25, kTwoPi * 0.83}},
                                .duration_s = 25.0,
                                .step_s = 1e-5,
                                .each = 1000,
                                .inertia_kgm2 = 0.5,
                                .viscous_Nms_per_rad = 0.1,
                                .coulomb_Nm = 0.3,
                                .load_kgm2 = load_kgm2,
                                .half_gap_rad = 0.02,
                                .load_friction_per_s2 = 0.3,
                                .contact_rad_per_s = kTwoPi * 40.0,
                                .contact_damping = 0.5,
                                .load_start = begin,
                                .torque_noise_Nm = kNoise_Nm},
                               seed);
  for (int k = 0; k < spikes; ++k)
    record.torque[131 + 227 * static_cast<std::size_t>(k)] += (k % 2 == 0 ? 15.0 : -12.0) * kNoise_Nm;
  return record;
}

bool LeavesOut(const Study& study, const std::string& count) {
  return std::ranges::any_of(
      study.warnings(), [&](const std::string& warning) { return warning.starts_with(count + " samples"); });
}

TEST(MotionBacklash, IsNamedByImpactsThatLastOneSample) {
  const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {SlowlyLogged(1, 0.003, 0)});
  EXPECT_EQ(found.names(), Names{"backlash"});
  EXPECT_TRUE(found.study->warnings().empty());
}

TEST(MotionBacklash, LeavesOutTheSpikesThatNoInertiaBehindBacklashPredicts) {
  const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {SlowlyLogged(1, 0.003, 7)});
  EXPECT_EQ(found.names(), Names{"backlash"});
  EXPECT_TRUE(LeavesOut(*found.study, "7"));
  const Diagnosed tight = DiagnoseRecords(&MakeMotionStudy, {SlowlyLogged(1, 0.0, 7)});
  EXPECT_TRUE(tight.names().empty());
  EXPECT_TRUE(LeavesOut(*tight.study, "7"));
}

// Of eight samples that stand off one is an impact. An outlier beside a turn would look the same.
TEST(MotionBacklash, TakesNoSpikeForAnImpactThatStandsAlone) {
  const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {SlowlyLogged(4, 0.002, 7)});
  EXPECT_EQ(found.names(), Names{"backlash"});
  EXPECT_TRUE(LeavesOut(*found.study, "8"));
}

// Its six numbers pay for what chance can do with them, not once more for each sample of the record.
TEST(MotionBacklash, IsNamedWhereItIsBeyondChanceThoughFewSamplesKnowIt) {
  const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {SlowlyLogged(1, 0.0006, 0)});
  ASSERT_EQ(found.names(), Names{"backlash"});
  EXPECT_GT(found.diagnosis.causes.front().evidence.delta_bic, 0.0);
}

// A low-pass keeps half of an impact of one sample, and takes the noise of its neighbours in.
TEST(MotionBacklash, IsNamedByImpactsThatALowPassWouldHide) {
  for (const unsigned seed : {1U, 2U, 3U, 4U})
    EXPECT_EQ(DiagnoseRecords(&MakeMotionStudy, {SlowlyLogged(seed, 0.0007, 0)}).names(), Names{"backlash"})
        << seed;
}

// Of a load that is light beside the noise the first impact alone does not tell.
TEST(MotionBacklash, FindsAtWhichEndOfItsGapTheLoadBegins) {
  for (const unsigned seed : {1U, 2U, 5U}) {
    for (const double load_kgm2 : {0.02, 0.06}) {
      const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {SlowlyLogged(seed, load_kgm2, 0, -1.0)});
      ASSERT_EQ(found.names(), Names{"backlash"}) << load_kgm2;
      EXPECT_LT(found.value("load_start").value, -0.7) << load_kgm2;
    }
  }
}

// A wider gap is crossed in the same time if the load is braked less in it: along that lie many optima.
TEST(MotionBacklash, TellsAWideGapFromALoadThatIsBrakedLess) {
  constexpr double kLoad_kgm2 = 0.006;
  for (const double begin : {-1.0, 1.0}) {
    const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {SlowlyLogged(1, kLoad_kgm2, 0, begin)});
    ASSERT_EQ(found.names(), Names{"backlash"}) << begin;
    EXPECT_NEAR(found.value("backlash_rad").value, 0.04, 0.001) << begin;
    EXPECT_NEAR(found.value("load_friction_Nm").value, 0.3 * kLoad_kgm2, 0.06 * kLoad_kgm2) << begin;
  }
}

// Where in its gap the load is at first is a state of the record: in full each of the six numbers of the gap
// would be charged. (Noise hides at which moment exactly the load is met first.)
TEST(MotionBacklash, IsHardlyChargedForWhereTheLoadBegins) {
  MotionData record = Record(1);
  std::mt19937 random(2);
  std::normal_distribution<double> more_noise(0.0, 2.0);
  for (double& torque : record.torque) torque += more_noise(random);
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
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_backlash_test
