// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_friction_test {
namespace {

// One speed after the other, each as long, from one to the next as a half cosine.
struct Staircase {
  std::vector<double> speeds_rad_per_s;
  double rate_Hz{};
  double spell_s{};
  double turn_s{};
  double inertia_kgm2{};
  double noise_Nm{};
};

// Of time, position and speed.
using Load = std::function<double(double time_s, double position_rad, double speed_rad_per_s)>;

MotionData Record(unsigned seed, const Staircase& staircase, const Load& load_Nm) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, staircase.noise_Nm);
  MotionData record;
  double position_rad = 0.0;
  const auto& speeds = staircase.speeds_rad_per_s;
  const auto samples =
      static_cast<int>(staircase.rate_Hz * staircase.spell_s * static_cast<double>(speeds.size()));
  for (int i = 0; i < samples; ++i) {
    const double time_s = i / staircase.rate_Hz;
    const auto spell = std::min(static_cast<std::size_t>(time_s / staircase.spell_s), speeds.size() - 1);
    const double before = spell > 0 ? speeds[spell - 1] : 0.0;
    const double change = speeds[spell] - before;
    const double u =
        std::min((time_s - static_cast<double>(spell) * staircase.spell_s) / staircase.turn_s, 1.0);
    const double speed = before + change * 0.5 * (1.0 - std::cos(kPi * u));
    const double acceleration = u < 1.0 ? change * 0.5 * kPi / staircase.turn_s * std::sin(kPi * u) : 0.0;
    record.time_s.push_back(time_s);
    record.position.push_back(position_rad);
    record.torque.push_back(staircase.inertia_kgm2 * acceleration + load_Nm(time_s, position_rad, speed) +
                            noise(random));
    position_rad += (speed + 0.5 * acceleration / staircase.rate_Hz) / staircase.rate_Hz;
  }
  return record;
}

Diagnosed Ask(const MotionData& record) { return DiagnoseRecords(&MakeMotionStudy, {record}); }

// Once up the speeds, to and fro at each, while the grease warms: speed and time go together, and what is
// lost in Coulomb friction could nearly as well be lost in viscous friction.
TEST(MotionFriction, ThatWarmsWhileSpeedsRiseIsNotTakenForOneOfLowSpeed) {
  const Staircase up{
      .speeds_rad_per_s = {0.02, -0.02, 0.05, -0.05, 0.1, -0.1, 0.2, -0.2, 0.4, -0.4, 0.7, -0.7, 1.0, -1.0},
      .rate_Hz = 1000.0,
      .spell_s = 20.0 / 14.0,
      .turn_s = 0.15,
      .inertia_kgm2 = 2.0,
      .noise_Nm = 0.14};
  const Diagnosed found = Ask(Record(1, up, [](double time_s, double, double speed) {
    return 4.77 * speed + (4.48 + 0.15 * std::exp(-time_s / 5.0)) * std::tanh(speed / 1e-4) - 1.5;
  }));
  EXPECT_EQ(found.names(), Names{"thermal_friction_drift"});
  // Mean rate over the record, of the friction at its start.
  const ParameterValue drift = found.value("drift_per_h");
  const double lost = 0.15 * (1.0 - std::exp(-20.0 / 5.0)) / (4.48 + 0.15);
  EXPECT_NEAR(drift.value, -lost * 3600.0 / 20.0, 4.0 * drift.standard_error);
}

// Samples crowd where the axis creeps, and raise all low orders with the ripple.
TEST(MotionFriction, DoesNotHideARippleOnAStaircase) {
  const Staircase mixed{
      .speeds_rad_per_s = {0.4, 1.5, 0.05, 1.9, -0.12, 0.03, -1.7, 0.25, -0.15, 0.06, -0.2, 0.5, -0.03, 0.04},
      .rate_Hz = 125.0,
      .spell_s = 3.6,
      .turn_s = 0.2,
      .inertia_kgm2 = 0.07,
      .noise_Nm = 0.096};
  const Diagnosed found = Ask(Record(2, mixed, [](double, double position, double speed) {
    return 0.04 * speed + 0.59 * std::tanh(speed / 1e-3) + 0.218 * std::sin(25.0 * position + 0.3);
  }));
  EXPECT_EQ(found.names(), Names{"position_periodic_torque"});
  const ParameterValue order = found.value("order_per_turn");
  EXPECT_NEAR(order.value, 25.0, 4.0 * order.standard_error);
}

// A seal or bearing off centre: against the motion, whichever way it goes.
TEST(MotionFriction, ThatRepeatsWithPositionIsNamed) {
  const Staircase mixed{
      .speeds_rad_per_s = {0.4, -0.5, 1.5, -1.4, 0.6, 1.9, -1.2, 0.8, -1.7, 1.3, -0.7, 1.6, -0.9, 0.5},
      .rate_Hz = 125.0,
      .spell_s = 3.6,
      .turn_s = 0.2,
      .inertia_kgm2 = 0.07,
      .noise_Nm = 0.096};
  const Diagnosed found = Ask(Record(3, mixed, [](double, double position, double speed) {
    return 0.04 * speed + (0.59 + 0.1 * std::sin(12.0 * position + 0.3)) * std::tanh(speed / 1e-3);
  }));
  EXPECT_EQ(found.names(), Names{"position_periodic_torque"});
  const ParameterValue order = found.value("order_per_turn");
  EXPECT_NEAR(order.value, 12.0, 4.0 * order.standard_error);
  const ParameterValue amplitude = found.value("friction_amplitude_Nm");
  EXPECT_NEAR(amplitude.value, 0.1, 4.0 * amplitude.standard_error);
}

// What a single fast move says of friction is not to be predicted from the slow ones: held out are parts of a
// move, never the whole of it.
TEST(MotionFriction, OfASingleFastMoveIsNotHeldOutAtOnce) {
  const Staircase once_fast{.speeds_rad_per_s = {0.1, -0.15, 0.1, -0.12, 0.12, -0.1, 1.0, -0.1, 0.12, -0.1},
                            .rate_Hz = 500.0,
                            .spell_s = 1.0,
                            .turn_s = 0.2,
                            .inertia_kgm2 = 2.0,
                            .noise_Nm = 0.2};
  const MotionData record = Record(
      3, once_fast, [](double, double, double speed) { return 2.0 * speed + 0.6 * std::tanh(speed / 1e-3); });
  const std::unique_ptr<Study> study = MakeMotionStudy({&record, 1});
  EXPECT_LE(3 * study->BlockLength(), study->measured().size() / once_fast.speeds_rad_per_s.size());
}

// An axis that turns fast: what friction does at low speed is over within two samples of a reversal.
TEST(MotionFriction, OfLowSpeedShowsWhereAnAxisTurnsFast) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    MotionData record;
    for (int i = 0; i < 3500; ++i) {
      const double time_s = i / 200.0;
      double position = 0.0, speed = 0.0, acceleration = 0.0;
      for (const auto& [size, rad_per_s] : {std::pair{2.2, 11.6}, std::pair{1.1, 4.3}, std::pair{0.8, 2.3}}) {
        position += size * std::sin(rad_per_s * time_s);
        speed += size * rad_per_s * std::cos(rad_per_s * time_s);
        acceleration -= size * rad_per_s * rad_per_s * std::sin(rad_per_s * time_s);
      }
      record.time_s.push_back(time_s);
      record.position.push_back(position + 2e-7 * normal(random));
      record.torque.push_back(0.5 * acceleration + 2.6 * speed +
                              std::tanh(speed / 0.01) * (42.0 + 6.0 * std::exp(-std::abs(speed / 1.3))) +
                              3.2 * normal(random));
    }
    EXPECT_EQ(Ask(record).names(), Names{"stribeck_friction"}) << seed;
  }
}

// An axis that never turns: a friction that falls from the slowest speed on is no reversal smoothing from one
// direction to the other that the nominal model could have.
TEST(MotionFriction, OfLowSpeedShowsWhereAnAxisNeverTurns) {
  const Diagnosed found =
      Ask(Record(8,
                 {.speeds_rad_per_s = {0.006, 0.012, 0.018, 0.024, 0.03, 0.036, 0.042, 0.048, 0.054, 0.06,
                                       0.066, 0.072, 0.078, 0.085},
                  .rate_Hz = 50.0,
                  .spell_s = 7.0,
                  .turn_s = 0.2,
                  .inertia_kgm2 = 1.7,
                  .noise_Nm = 0.023},
                 [](double, double, double speed) {
                   return 2.0 + 14.4 * speed + 0.104 * std::exp(-std::pow(speed / 0.0113, 2.0));
                 }));
  ASSERT_EQ(found.names(), Names{"stribeck_friction"});
  const ParameterValue speed = found.value("stribeck_speed_rad_per_s");
  EXPECT_NEAR(speed.value, 0.0113, 4.0 * speed.standard_error);
}

// Three speeds each way leave a drag little beside Coulomb and viscous friction, but so much that nobody
// would overlook it.
TEST(MotionFriction, MayBeADragThatThreeSpeedsShow) {
  const Diagnosed answer =
      Ask(Record(7,
                 {.speeds_rad_per_s = {1.0, -1.0, 0.8, -0.8, 0.6, -0.6, 1.0, -1.0, 0.8, -0.8, 0.6, -0.6},
                  .rate_Hz = 200.0,
                  .spell_s = 4.0,
                  .turn_s = 0.05,
                  .inertia_kgm2 = 0.1,
                  .noise_Nm = 0.01},
                 [](double, double, double speed) {
                   const double direction = std::tanh(speed / 1e-3);
                   return 0.7 * direction + 0.4 * speed + 0.3 * speed * std::abs(speed);
                 }));
  ASSERT_EQ(answer.names(), Names{"quadratic_drag"});
  const ParameterValue drag = answer.value("drag_Nms2_per_rad2");
  EXPECT_NEAR(drag.value, 0.3, 4.0 * drag.standard_error);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_friction_test
