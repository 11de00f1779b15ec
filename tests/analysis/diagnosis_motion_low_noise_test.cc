// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/diagnosis/motion/bandwidth.h"
#include "analysis/diagnosis/motion/grid.h"
#include "analysis/diagnosis/motion/samples.h"
#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_low_noise_test {
namespace {

constexpr double kInertia_kgm2 = 0.1;
constexpr double kViscous_Nms_per_rad = 0.1;
constexpr double kSpell_s = 2.1;

// Constant speed for 2.1 s, then the other way around within 90 ms as a half cosine: nothing accelerates but
// for a twentieth of the time, and there it matters.
struct Turns {
  double rate_Hz{200.0};
  double path_noise_rad{1.3e-4};
  double torque_noise_Nm{0.12};
  double coulomb_Nm{0.6};
  double width_rad_per_s{0.01};  // of the reversal smoothing of Coulomb friction through zero speed
  double turn_s{0.09};
  double late_s{};  // by which the torque is recorded late
};

struct State {
  double position_rad{}, speed_rad_per_s{}, acceleration_rad_per_s2{};
};

State At(double time_s, double turn_s) {
  State state;
  double speed = 1.0;
  double start_s = 0.0;
  for (int k = 0; k < 40; ++k) {
    const double since_s = time_s - (start_s + kSpell_s);
    if (since_s < 0.0) break;
    const double change = (k % 2 == 0 ? -1.0 : 1.0) * (2.2 + std::sin(2.3 * k));
    const double u = std::min(since_s / turn_s, 1.0);
    state.position_rad +=
        change * (0.5 * turn_s * (u - std::sin(kPi * u) / kPi) + std::max(since_s - turn_s, 0.0));
    state.speed_rad_per_s += change * 0.5 * (1.0 - std::cos(kPi * u));
    if (u < 1.0) state.acceleration_rad_per_s2 += change * 0.5 * kPi / turn_s * std::sin(kPi * u);
    start_s += kSpell_s;
  }
  state.position_rad += speed * time_s;
  state.speed_rad_per_s += speed;
  return state;
}

MotionData Record(unsigned seed, const Turns& turns) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  for (int i = 0; i < static_cast<int>(40.0 * turns.rate_Hz); ++i) {
    const double time_s = i / turns.rate_Hz;
    const State then = At(time_s - turns.late_s, turns.turn_s);
    record.time_s.push_back(time_s);
    record.position.push_back(At(time_s, turns.turn_s).position_rad + turns.path_noise_rad * normal(random));
    record.torque.push_back(kInertia_kgm2 * then.acceleration_rad_per_s2 +
                            kViscous_Nms_per_rad * then.speed_rad_per_s +
                            turns.coulomb_Nm * std::tanh(then.speed_rad_per_s / turns.width_rad_per_s) +
                            turns.torque_noise_Nm * normal(random));
  }
  return record;
}

Diagnosed Ask(const MotionData& record) { return DiagnoseRecords(&MakeMotionStudy, {record}); }

// Kept narrow for the turns, the smoothing lets the path's noise through all the time between them: the
// inertia comes out a third too small, and what that leaves at the turns passes for more than the nominal
// model.
TEST(MotionLowNoise, DoesNotShowThePathsNoiseAsAcceleration) {
  for (const unsigned seed : {2U, 3U}) {
    const Diagnosed clean = Ask(Record(seed, {}));
    EXPECT_EQ(clean.names(), Names());
    EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect) << seed;
    const ParameterValue inertia = clean.nominal("inertia_kgm2");
    EXPECT_NEAR(inertia.value, kInertia_kgm2, 4.0 * inertia.standard_error) << seed;
  }
}

TEST(MotionLowNoise, LetsADelayBeTold) {
  const Diagnosed late =
      Ask(Record(4, {.path_noise_rad = 2e-5, .torque_noise_Nm = 0.03, .turn_s = 0.04, .late_s = 0.004}));
  EXPECT_EQ(late.names(), Names{"time_delay"});
  const ParameterValue delay = late.value("delay_s");
  EXPECT_NEAR(delay.value, -0.004, 4.0 * delay.standard_error);
}

// Coulomb friction as many a simulation has it, tanh(v/v₀), seen only where it is nearly all there.
TEST(MotionLowNoise, TakesAReversalSmoothingForNothingElse) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  MotionData record;
  for (int i = 0; i < 20000; ++i) {
    const double time_s = 0.0005 * i;
    const double slow = 2.0 * kTwoPi * 0.3;
    const double fast = 0.6 * kTwoPi * 1.1;
    const double speed =
        slow * std::cos(kTwoPi * 0.3 * time_s) + fast * std::cos(kTwoPi * 1.1 * time_s + 0.7);
    record.time_s.push_back(time_s);
    record.position.push_back(2.0 * std::sin(kTwoPi * 0.3 * time_s) +
                              0.6 * std::sin(kTwoPi * 1.1 * time_s + 0.7) + 2e-6 * normal(random));
    record.torque.push_back(-0.2 * (slow * kTwoPi * 0.3 * std::sin(kTwoPi * 0.3 * time_s) +
                                    fast * kTwoPi * 1.1 * std::sin(kTwoPi * 1.1 * time_s + 0.7)) +
                            0.3 * speed + 2.0 * std::tanh(speed / 0.06) + 0.02 * normal(random));
  }
  const Diagnosed clean = Ask(record);
  EXPECT_EQ(clean.names(), Names());
  EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect);
}

// Moves of steady speed between ramps at whose ends the jerk jumps, 50 samples a second of an encoder of 4
// million steps a turn: the path has nearly nothing but those kinks above 5 Hz, far above its noise,
// and the torque follows.
MotionData Moves(double unit_s) {
  struct Ramp {
    double start, length, change_rad_per_s;  // in units
  };
  constexpr Ramp kRamps[] = {{0.142, 0.420, -0.622}, {0.922, 0.420, 0.622},  {1.589, 0.191, 0.448},
                             {2.434, 0.191, -0.448}, {2.625, 0.359, 0.546},  {3.790, 0.359, -0.546},
                             {4.335, 0.480, -0.726}, {5.521, 0.480, 0.726},  {6.087, 0.479, 0.339},
                             {7.401, 0.479, -0.339}, {7.880, 0.296, -0.646}, {9.448, 0.296, 0.646}};
  constexpr double kStep_rad = 1.5e-6;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  MotionData record;
  for (int i = 0; i < static_cast<int>(500 * unit_s); ++i) {
    const double time_s = 0.02 * i;
    State state;
    for (const Ramp& ramp : kRamps) {
      const double length_s = unit_s * ramp.length;
      const double x = (time_s - unit_s * ramp.start) / length_s;
      const double u = std::clamp(x, 0.0, 1.0);
      const double beyond = std::max(x - 1.0, 0.0);
      state.position_rad += ramp.change_rad_per_s * length_s * (u * u * u * (1.0 - 0.5 * u) + beyond);
      state.speed_rad_per_s += ramp.change_rad_per_s * u * u * (3.0 - 2.0 * u);
      state.acceleration_rad_per_s2 += ramp.change_rad_per_s / length_s * 6.0 * u * (1.0 - u);
    }
    record.time_s.push_back(time_s);
    record.position.push_back(kStep_rad * std::round(state.position_rad / kStep_rad));
    record.torque.push_back(2.1 * state.acceleration_rad_per_s2 + 1.5 * state.speed_rad_per_s +
                            0.87 * std::tanh(state.speed_rad_per_s / 3e-4) + 0.043 * normal(random));
  }
  return record;
}

TEST(MotionLowNoise, KeepsTheKinksThatTheTorqueFollows) {
  for (const double unit_s : {0.5, 0.6, 0.9}) {
    const MotionData record = Moves(unit_s);
    const MotionBandwidth bandwidth = ChooseBandwidth(PrepareMotion({{record}}), kMostRows);
    EXPECT_DOUBLE_EQ(bandwidth.path_sigma_s, bandwidth.sigma_s) << unit_s;
    EXPECT_EQ(Ask(record).diagnosis.verdict, Verdict::kNoEffect) << unit_s;
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_low_noise_test
