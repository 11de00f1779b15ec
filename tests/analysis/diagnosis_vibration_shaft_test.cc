// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/speed_band.h"
#include "analysis/units.h"
#include "tests/analysis/message_of.h"
#include "tests/analysis/vibration_record.h"

// Records whose shaft changes its speed, with a column of speeds or of angles.
namespace strainwave::analysis::diagnosis::diagnosis_vibration_shaft_test {
namespace {

double TurnsAt(const SpeedBand& band) { return band.turns; }

VibrationRun RunOf(const VibrationData& record) { return PrepareVibration({&record, 1}).runs.front(); }

// At standstill there is no order, and next to it a frequency stands at the highest ones.
TEST(VibrationShaft, FindsNothingInARunUpFromStandstill) {
  const Diagnosed answer = Ask({Record(Turning(900.0, 1.5, 2.0), 61, Silence)});
  EXPECT_EQ(answer.diagnosis.verdict, Verdict::kNoEffect);
}

TEST(VibrationShaft, NamesABearingInARunUpFromStandstill) {
  const Turning run(900.0, 2.0, 2.0);
  const Effect rings = [](const Turning& turning) {
    Signal signal = Silence(turning);
    constexpr double kOrder = 5.37;
    int next = 1;
    for (std::size_t i = 1; i < turning.time_s.size(); ++i) {
      if (turning.angle_rad[i] * kOrder / kTwoPi < next) continue;
      const double since = turning.angle_rad[i] - next * kTwoPi / kOrder;
      AddRinging(turning, turning.time_s[i] - since / std::max(1.0, turning.speed_rad_per_s[i]), 0.5, 1100.0,
                 0.04, signal);
      ++next;
    }
    return signal;
  };
  const Diagnosed answer = Ask({Record(run, 62, rings)});
  EXPECT_EQ(answer.names(), Names{"bearing_defect"});
  EXPECT_NEAR(answer.value("defect_order").value, 5.37, 0.01);
}

TEST(BandWithin, HoldsAllTurnsWhereTheyAreNotTooMuchWork) {
  const VibrationRun steady = RunOf(Record(Turning(1500.0, 1.0, 0.0), 63, Silence));
  const SpeedBand all = BandWithin(steady, 1e3, TurnsAt);
  EXPECT_NEAR(all.turns, 25.0, 0.1);
  EXPECT_NEAR(all.span, 25.0, 0.1);
  EXPECT_EQ(BandWithin(steady, 1.0, TurnsAt).turns, 0.0);
}

// From standstill to 1800 rpm in a second and a half the shaft makes 22.5 turns, the last half of them from
// 1273 rpm on.
TEST(BandWithin, LeavesOutTheSlowTurnsOfARunUp) {
  const VibrationRun run = RunOf(Record(Turning(900.0, 1.5, 2.0), 64, Silence));
  const auto orders = [](const SpeedBand& band) { return 1e5 / band.slowest_rad_per_s; };
  const SpeedBand band = BandWithin(run, 1e5 / RadPerSFromRpm(900.0), orders);
  EXPECT_GE(band.slowest_rad_per_s, RadPerSFromRpm(900.0));
  EXPECT_LT(band.slowest_rad_per_s, RadPerSFromRpm(1000.0));
  EXPECT_NEAR(band.fastest_rad_per_s, RadPerSFromRpm(1800.0), 1.0);
  EXPECT_GT(band.turns, 0.65 * run.turns);
  EXPECT_EQ(BandWithin(run, 1e5 / RadPerSFromRpm(1400.0), orders).turns, 0.0);
}

bool SaysThatItWanders(const VibrationData& record) {
  return std::ranges::any_of(PrepareVibration({&record, 1}).warnings, [](const std::string& warning) {
    return warning.starts_with("the speed wanders more than the file says");
  });
}

TEST(VibrationShaft, FollowsASpeedThatWandersMoreThanTheFileSays) {
  Turning run(1500.0, 3.0, 0.0);
  for (std::size_t i = 0; i < run.time_s.size(); ++i)
    run.angle_rad[i] += 0.15 * std::sin(kTwoPi * 0.7 * run.time_s[i]);
  const VibrationData record = Record(run, 71, Silence);
  EXPECT_TRUE(SaysThatItWanders(record));
  EXPECT_EQ(Ask({record}).diagnosis.verdict, Verdict::kNoEffect);
}

Effect Crack(double height) {
  return [height](const Turning& run) {
    Signal signal;
    for (const double angle : run.angle_rad) {
      const double passings = 2.025 * angle / kTwoPi + 0.2;
      const double off = (passings - std::round(passings)) / 0.04;
      signal.push_back(height * std::exp(-0.5 * off * off) * (1.0 + 0.45 * std::cos(angle / 80.0 + 5.7)));
    }
    return signal;
  };
}

// A crack's lines beside the shaft's are a wander of the second one that the first one does not join in.
TEST(VibrationShaft, FollowsNoLinesOfACrack) {
  for (double duration_s = 3.0; duration_s < 4.5; duration_s += 0.1)
    EXPECT_FALSE(SaysThatItWanders(Record(Turning(3000.0, duration_s, 0.0), 72, Crack(0.3)))) << duration_s;
}

// Where the speed was measured, a lag and another scale would meet a strong crack somewhere.
TEST(VibrationShaft, KeepsTheMeasuredAngleBesideAStrongCrack) {
  for (unsigned seed = 73; seed < 79; ++seed) {
    const Turning turning(1950.0, 2.8 + 0.1 * (seed - 73), 0.08);
    EXPECT_NEAR(RunOf(Record(turning, seed, Crack(3.0))).turns, turning.turns(), 1e-3) << seed;
  }
}

TEST(VibrationShaft, TakesAngleAndSpeedFromAColumnOfAngles) {
  const Turning turning(1200.0, 1.0, 0.8);
  const VibrationRun by_speed = RunOf(Record(turning, 65, Silence));
  VibrationData record = Record(turning, 65, Silence);
  record.input_speed_rad_per_s.clear();
  record.input_angle_rad = turning.angle_rad;
  const auto expect_the_same = [&] {
    const VibrationRun run = RunOf(record);
    ASSERT_EQ(run.size(), by_speed.size());
    EXPECT_NEAR(run.turns, by_speed.turns, 1e-3);
    EXPECT_NEAR(run.mean_speed_rad_per_s, by_speed.mean_speed_rad_per_s, 0.01);
    for (std::size_t i = 100; i + 100 < run.size(); i += 100) {
      EXPECT_NEAR(run.angle_rad[i], by_speed.angle_rad[i], 1e-3) << i;
      EXPECT_NEAR(run.speed_rad_per_s[i], by_speed.speed_rad_per_s[i], 0.1) << i;
    }
  };
  expect_the_same();
  // The other way round.
  for (double& angle : record.input_angle_rad) angle = 1e4 - angle;
  expect_the_same();
  // Anew each turn.
  for (double& angle : record.input_angle_rad) angle -= kTwoPi * std::floor(angle / kTwoPi);
  expect_the_same();
}

// A tachometer that filters is late: both lines of the shaft turn by as much time.
TEST(VibrationShaft, TakesALateColumnOfSpeedsForNoEffect) {
  const Turning turning(1200.0, 2.0, 1.2);
  VibrationData record = Record(turning, 66, Silence);
  constexpr std::size_t kLate = 30;  // samples
  for (std::size_t i = record.time_s.size(); i-- > 0;)
    record.input_speed_rad_per_s[i] = turning.speed_rad_per_s[i > kLate ? i - kLate : 0];
  const Diagnosed answer = Ask({record});
  EXPECT_EQ(answer.diagnosis.verdict, Verdict::kNoEffect);
  ASSERT_FALSE(answer.study->warnings().empty());
  EXPECT_EQ(answer.study->warnings().back().substr(0, 31), "the angle of the shaft stands 5");  // 5.9 ± 0.4
  EXPECT_NE(answer.study->warnings().back().find(" ms behind"), std::string::npos);
}

// A strong line has sidelobes where a weak line of half its frequency, or of twice, would stand.
TEST(VibrationShaft, ReadsTheSpeedOffAPairOfWhichOneLineIsMuchStronger) {
  for (const double stronger : {1.0, 2.0}) {
    const Turning turning(1609.0, 0.3, 0.0);
    VibrationData record = Record(turning, 67, Silence);
    record.channels.front().values = record.channels.front().values + Line(turning, stronger, 2.0);
    record.input_speed_rad_per_s.clear();
    EXPECT_NEAR(RpmFromRadPerS(RunOf(record).mean_speed_rad_per_s), 1609.0, 1.0) << stronger;
  }
}

// Nothing is stated that could speak against the best fit: its turns are as sure as the strong line says, to
// 0.15 thousandths.
TEST(VibrationShaft, TakesASpeedThatNobodyStatesAsTheLinesSayIt) {
  for (unsigned seed = 70; seed < 90; ++seed) {
    const Turning turning(816.0 + 0.1 * seed, 7.2, 0.0);
    VibrationData record = Record(turning, seed, Silence);
    record.channels.front().values =
        record.channels.front().values + Line(turning, 1.0, 0.35) + Line(turning, 2.0, 1.0);
    record.input_speed_rad_per_s.clear();
    EXPECT_NEAR(RunOf(record).turns, turning.turns(), 6e-4) << seed;
  }
}

TEST(VibrationShaft, RefusesAShaftThatDoesNotTurnOneWay) {
  const auto message = [](const VibrationData& record) { return RefusalOf(&MakeVibrationStudy, record); };
  VibrationData record = Record(Turning(1500.0, 1.0, 0.0), 67, Silence);
  record.input_speed_rad_per_s.assign(record.time_s.size(), 0.0);
  EXPECT_EQ(message(record), "the input speed is zero (expected a turning shaft)");
  for (std::size_t i = 0; i < record.time_s.size(); ++i)
    record.input_speed_rad_per_s[i] = 80.0 * std::cos(kTwoPi * record.time_s[i]);
  EXPECT_EQ(message(record),
            "the input shaft turns 2.03 turns forth and 2.03 back (expected a shaft that turns one way)");
  record.input_speed_rad_per_s = {RadPerSFromRpm(1e9)};
  EXPECT_EQ(message(record),
            "the input shaft makes 3255 turns a sample, 1e+09 rpm (expected at least 4 samples a turn, and a "
            "speed in rpm or an angle in degrees)");
  record.input_angle_rad.assign(100, 0.0);
  EXPECT_EQ(message(record), "100 values of the input angle for 5120 samples (expected one a sample)");
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_vibration_shaft_test
