// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_delay_test {
namespace {

constexpr double kRate_Hz = 200.0;
constexpr double kDelay_s = 0.002;
constexpr double kNoise_Nm = 0.0003;

// A light axis that turns twice in 20 s, whose torque is that of `delay_s` later; samples are taken up to a
// tenth of a step late, and dated right.
MotionData Record(unsigned seed, double delay_s, double coulomb_Nm = 0.002, double drag_Nms2_per_rad2 = 0.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> late(0.0, 0.2);
  MotionData record;
  for (std::size_t i = 0; i < static_cast<std::size_t>(20.0 * kRate_Hz); ++i) {
    const double time_s = (static_cast<double>(i) + late(random)) / kRate_Hz;
    const auto slow = [](double at_s) { return kTwoPi * 0.05 * at_s; };
    const auto fast = [](double at_s) { return kTwoPi * 0.9 * at_s; };
    const auto speed = [&](double at_s) { return 3.0 * std::cos(slow(at_s)) + 0.2 * std::cos(fast(at_s)); };
    const double then_s = time_s + delay_s;
    const double acceleration =
        -3.0 * kTwoPi * 0.05 * std::sin(slow(then_s)) - 0.2 * kTwoPi * 0.9 * std::sin(fast(then_s));
    record.time_s.push_back(time_s);
    record.position.push_back(3.0 / (kTwoPi * 0.05) * std::sin(slow(time_s)) +
                              0.2 / (kTwoPi * 0.9) * std::sin(fast(time_s)) + 1e-6 * normal(random));
    record.torque.push_back(
        0.03 * acceleration + 0.007 * speed(then_s) + coulomb_Nm * std::tanh(speed(then_s) / 0.005) +
        drag_Nms2_per_rad2 * speed(then_s) * std::abs(speed(then_s)) + kNoise_Nm * normal(random));
  }
  return record;
}

// Of two turns alone nobody would know it, where each is known to a step of 5 ms.
TEST(MotionDelay, IsKnownByInertiaWhereSamplesComeLate) {
  for (const unsigned seed : {1U, 2U}) {
    const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {Record(seed, kDelay_s)});
    EXPECT_EQ(found.names(), Names{"time_delay"}) << seed;
    if (found.names() == Names{"time_delay"}) {
      const ParameterValue delay = found.value("delay_s");
      EXPECT_NEAR(delay.value, kDelay_s, 4.0 * delay.standard_error) << seed;
    }
    const Diagnosed clean = DiagnoseRecords(&MakeMotionStudy, {Record(seed, 0.0)});
    EXPECT_EQ(clean.names(), Names()) << seed;
  }
}

// Of two clocks either may be ahead, and a filter makes the torque's signal late.
TEST(MotionDelay, IsNamedAlsoWhereTheTorqueIsRecordedLate) {
  for (const double delay_s : {-0.004, -0.03}) {
    const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {Record(4, delay_s, 0.02)});
    ASSERT_EQ(found.names(), Names{"time_delay"}) << delay_s;
    const ParameterValue delay = found.value("delay_s");
    EXPECT_NEAR(delay.value, delay_s, 4.0 * delay.standard_error);
    const CauseRule& rule = found.study->causes()[found.diagnosis.causes.front().index];
    EXPECT_TRUE(rule.sentence.starts_with("the torque is recorded later than it acts")) << rule.sentence;
  }
}

// Without the drag a viscous friction stands in for it, and what a delay does to that one is not what it
// does.
TEST(MotionDelay, IsTakenBesideWhatElseMovesWithIt) {
  const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {Record(3, 0.05, 0.03, 0.01)});
  EXPECT_EQ(found.names(), (Names{"time_delay", "quadratic_drag"}));
  const ParameterValue delay = found.value("delay_s");
  EXPECT_NEAR(delay.value, 0.05, 4.0 * delay.standard_error);
  EXPECT_NEAR(found.diagnosis.extended_heldout_rmse, kNoise_Nm, 0.1 * kNoise_Nm);
}

// What a delay does to a single tone other inertia and friction do as well: only where it turns does the
// friction come too early. There it is slow for some ten samples, and at rest in none of them.
TEST(MotionDelay, ShowsInTheTurnsOfASmoothMotion) {
  constexpr double kFast_Hz = 1000.0;
  constexpr double kTone_rad_per_s = 1.8;
  for (const unsigned seed : {1U, 2U}) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    MotionData record;
    for (std::size_t i = 0; i < 20000; ++i) {
      const double time_s = static_cast<double>(i) / kFast_Hz;
      const double phase = kTone_rad_per_s * time_s;
      const double later = phase + kTone_rad_per_s * 0.003;
      record.time_s.push_back(time_s);
      record.position.push_back(0.37 * std::sin(phase) + 1e-8 * normal(random));
      record.torque.push_back(-0.4 * std::sin(later) + 0.05 * std::cos(later) +
                              0.022 * std::tanh(std::cos(later) / 0.003) + 0.0025 * normal(random));
    }
    EXPECT_EQ(DiagnoseRecords(&MakeMotionStudy, {record}).names(), Names{"time_delay"}) << seed;
  }
}

// Friction that turns round within a sample or two says by how much it does so early, as soon as all
// reversals together have told over which speed it turns.
TEST(MotionDelay, ShowsInTheOneSampleOfAReversal) {
  for (const unsigned seed : {1U, 2U}) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    MotionData record;
    for (std::size_t i = 0; i < 6500; ++i) {
      const double time_s = static_cast<double>(i) / kRate_Hz;
      const auto speed = [](double at_s) { return 6.0 * std::cos(2.0 * at_s) + 5.0 * std::sin(0.9 * at_s); };
      const double then_s = time_s + 0.001;
      const double acceleration = -12.0 * std::sin(2.0 * then_s) + 4.5 * std::cos(0.9 * then_s);
      record.time_s.push_back(time_s);
      record.position.push_back(3.0 * std::sin(2.0 * time_s) - 5.0 / 0.9 * std::cos(0.9 * time_s) +
                                1e-7 * normal(random));
      record.torque.push_back(0.3 * acceleration + 0.24 * speed(then_s) +
                              0.34 * std::tanh(speed(then_s) / 0.02) + 0.06 * normal(random));
    }
    EXPECT_EQ(DiagnoseRecords(&MakeMotionStudy, {record}).names(), Names{"time_delay"}) << seed;
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_delay_test
