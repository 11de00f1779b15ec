// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Once up a staircase of speeds, to and fro at each, while the grease warms: speed and time go together, and
// what is lost in Coulomb friction could nearly as well be lost in viscous friction.
MotionData WarmingOnAStaircase(unsigned seed) {
  constexpr double kRate_Hz = 1000.0;
  constexpr double kSpell_s = 20.0 / 14.0;
  constexpr double kTurn_s = 0.15;
  constexpr double kSpeeds_rad_per_s[] = {0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0};
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.14);
  MotionData record;
  double position_rad = 0.0;
  const auto speed_of = [&](int spell) {
    return (spell % 2 == 0 ? 1.0 : -1.0) * kSpeeds_rad_per_s[spell / 2];
  };
  for (int i = 0; i < 20000; ++i) {
    const double time_s = i / kRate_Hz;
    const int spell = std::min(static_cast<int>(time_s / kSpell_s), 13);
    // From one speed to the next as a half cosine.
    const double before = spell > 0 ? speed_of(spell - 1) : 0.0;
    const double change = speed_of(spell) - before;
    const double u = std::min((time_s - spell * kSpell_s) / kTurn_s, 1.0);
    const double speed = before + change * 0.5 * (1.0 - std::cos(kPi * u));
    const double acceleration = u < 1.0 ? change * 0.5 * kPi / kTurn_s * std::sin(kPi * u) : 0.0;
    const double coulomb_Nm = 4.48 + 0.15 * std::exp(-time_s / 5.0);
    record.time_s.push_back(time_s);
    record.position.push_back(position_rad);
    record.torque.push_back(2.0 * acceleration + 4.77 * speed + coulomb_Nm * std::tanh(speed / 1e-4) - 1.5 +
                            noise(random));
    position_rad += (speed + 0.5 * acceleration / kRate_Hz) / kRate_Hz;
  }
  return record;
}

TEST(MotionFriction, ThatWarmsWhileSpeedsRiseIsNotTakenForOneOfLowSpeed) {
  const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {WarmingOnAStaircase(1)});
  EXPECT_EQ(found.names(), Names{"thermal_friction_drift"});
  // Mean rate over the record, of the friction at its start.
  const ParameterValue drift = found.value("drift_per_h");
  const double lost = 0.15 * (1.0 - std::exp(-20.0 / 5.0)) / (4.48 + 0.15);
  EXPECT_NEAR(drift.value, -lost * 3600.0 / 20.0, 4.0 * drift.standard_error);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis
