// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kFrequency_Hz = 3.0;
constexpr double kDamping = 0.03;

// A motion of two sines with a second inertia behind a spring, which swings when the record begins.
MotionData SwingingAtStart(unsigned seed, double start_rad = 0.008) {
  constexpr double kStep_s = 1e-4;
  constexpr int kEach = 100;
  constexpr double kDuration_s = 15.0;
  constexpr double kNatural = kTwoPi * kFrequency_Hz;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  double twist = start_rad;
  double twist_speed = 0.0;
  for (int i = 0; i * kStep_s < kDuration_s; ++i) {
    const double time_s = i * kStep_s;
    double position = 0.0, speed = 0.0, acceleration = 0.0;
    for (const auto& [omega, amplitude] : {std::pair{1.7, 2.0}, std::pair{5.9, 0.4}}) {
      position += amplitude * std::sin(omega * time_s);
      speed += amplitude * omega * std::cos(omega * time_s);
      acceleration -= amplitude * omega * omega * std::sin(omega * time_s);
    }
    const double swing =
        -acceleration - 2.0 * kDamping * kNatural * twist_speed - kNatural * kNatural * twist;
    if (i % kEach == 0) {
      record.time_s.push_back(time_s);
      record.position.push_back(position + 3e-7 * normal(random));
      record.torque.push_back(0.05 * acceleration + 0.01 * swing + 0.05 * speed +
                              0.3 * std::tanh(speed / 0.01) + 0.02 * normal(random));
    }
    twist_speed += kStep_s * swing;
    twist += kStep_s * twist_speed;
  }
  return record;
}

TEST(MotionResonance, MaySwingWhereTheRecordBegins) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {SwingingAtStart(seed)});
    EXPECT_EQ(found.names(), Names{"torsional_resonance"}) << seed;
    const ParameterValue frequency = found.value("frequency_Hz");
    EXPECT_NEAR(frequency.value, kFrequency_Hz, 3.0 * frequency.standard_error) << seed;
    const ParameterValue damping = found.value("damping_ratio");
    EXPECT_NEAR(damping.value, kDamping, 3.0 * damping.standard_error) << seed;
  }
}

// The gap hides what set it swinging, and in what phase it comes out of it.
TEST(MotionResonance, MaySwingWhereAGapEnds) {
  MotionData record = SwingingAtStart(1, 0.1);
  const auto at = [&](double time_s) {
    return std::ranges::lower_bound(record.time_s, time_s) - record.time_s.begin();
  };
  const auto first = at(1.0);
  const auto last = at(1.43);
  for (std::vector<double>* column : {&record.time_s, &record.position, &record.torque})
    column->erase(column->begin() + first, column->begin() + last);
  const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {record});
  EXPECT_EQ(found.names(), Names{"torsional_resonance"});
  const ParameterValue damping = found.value("damping_ratio");
  EXPECT_NEAR(damping.value, kDamping, 3.0 * damping.standard_error);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis
