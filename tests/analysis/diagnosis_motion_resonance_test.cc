// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_resonance_test {
namespace {

constexpr double kDamping = 0.03;
constexpr double kStruck_s = 3.0;

struct Axis {
  double frequency_Hz{3.0};
  double start_rad{0.008};  // twist of the spring
  double struck_rad{};      // by how much it is twisted later on
  double fast_rad_per_s{};  // of a third sine in its motion
  double fast_rad{};
};

// A motion of sines with a second inertia behind a spring, which swings when the record begins.
MotionData Swinging(unsigned seed, const Axis& axis) {
  constexpr double kStep_s = 1e-4;
  constexpr int kEach = 100;
  constexpr double kDuration_s = 15.0;
  const double natural = kTwoPi * axis.frequency_Hz;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  double twist = axis.start_rad;
  double twist_speed = 0.0;
  for (int i = 0; i * kStep_s < kDuration_s; ++i) {
    const double time_s = i * kStep_s;
    double position = 0.0, speed = 0.0, acceleration = 0.0;
    for (const auto& [omega, amplitude] :
         {std::pair{1.7, 2.0}, std::pair{5.9, 0.4}, std::pair{axis.fast_rad_per_s, axis.fast_rad}}) {
      position += amplitude * std::sin(omega * time_s);
      speed += amplitude * omega * std::cos(omega * time_s);
      acceleration -= amplitude * omega * omega * std::sin(omega * time_s);
    }
    if (time_s >= kStruck_s && time_s < kStruck_s + kStep_s) twist += axis.struck_rad;
    const double swing = -acceleration - 2.0 * kDamping * natural * twist_speed - natural * natural * twist;
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

void CutOut(MotionData& record, double from_s, double to_s) {
  const auto at = [&](double time_s) {
    return std::ranges::lower_bound(record.time_s, time_s) - record.time_s.begin();
  };
  const auto first = at(from_s);
  const auto last = at(to_s);
  for (std::vector<double>* column : {&record.time_s, &record.position, &record.torque})
    column->erase(column->begin() + first, column->begin() + last);
}

void ExpectResonance(const MotionData& record, double frequency_Hz) {
  const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {record});
  ASSERT_EQ(found.names(), Names{"torsional_resonance"});
  const ParameterValue frequency = found.value("frequency_Hz");
  EXPECT_NEAR(frequency.value, frequency_Hz, 3.0 * frequency.standard_error);
  const ParameterValue damping = found.value("damping_ratio");
  EXPECT_NEAR(damping.value, kDamping, 3.0 * damping.standard_error);
}

TEST(MotionResonance, MaySwingWhereTheRecordBegins) {
  for (const unsigned seed : {1U, 2U, 3U}) ExpectResonance(Swinging(seed, {}), 3.0);
}

// Nearly all of the swing is what the record began with: how heavy it is nobody can tell, that it is there is
// plain.
TEST(MotionResonance, MayBeginAndBeLittleElse) {
  for (const unsigned seed : {1U, 2U, 3U})
    ExpectResonance(Swinging(seed, {.frequency_Hz = 10.5, .start_rad = 0.0016}), 10.5);
}

// The gap hides what set it swinging, and in what phase it comes out of it.
TEST(MotionResonance, MaySwingWhereAGapEnds) {
  MotionData record = Swinging(1, {.start_rad = 0.1});
  CutOut(record, 1.0, 1.43);
  ExpectResonance(record, 3.0);
}

TEST(MotionResonance, MaySwingFarMoreThanTheMotion) {
  MotionData record =
      Swinging(1, {.start_rad = 0.03, .struck_rad = 0.05, .fast_rad_per_s = 25.0, .fast_rad = 0.1});
  CutOut(record, kStruck_s, 3.43);
  ExpectResonance(record, 3.0);
}

// Without the swing after the gap another frequency fits better.
TEST(MotionResonance, IsTheOneThatSwingsAfterAGap) {
  MotionData record = Swinging(
      1,
      {.frequency_Hz = 2.0, .start_rad = 0.0, .struck_rad = 0.02, .fast_rad_per_s = 40.0, .fast_rad = 0.03});
  CutOut(record, kStruck_s, 3.43);
  ExpectResonance(record, 2.0);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_resonance_test
