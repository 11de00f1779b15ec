// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "analysis/diagnosis/hysteresis/holds.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/diagnosed_loop.h"
#include "tests/analysis/generated_loop.h"

namespace strainwave::analysis::diagnosis::diagnosis_holds_test {
namespace {

constexpr double kNoise_Nm = 0.013;

// Half a cosine up to 34 Nm over 1000 samples, then 400 samples of hold, then down again.
std::vector<double> SmoothRampAndHold() {
  std::vector<double> torque_Nm;
  for (int i = 0; i < 2400; ++i) {
    const double way = (i < 1000 ? i : i < 1400 ? 1000 : 2400 - i) / 1000.0;
    torque_Nm.push_back(17.0 * (1.0 - std::cos(std::numbers::pi * way)));
  }
  return torque_Nm;
}

std::vector<double> WithNoise(std::vector<double> torque_Nm, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, kNoise_Nm);
  for (double& value : torque_Nm) value += normal(random);
  return torque_Nm;
}

TEST(FindHolds, FindsAHoldBetweenSmoothRamps) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const std::vector<Hold> holds = FindHolds(WithNoise(SmoothRampAndHold(), seed), kNoise_Nm);
    ASSERT_GE(holds.size(), 1U) << seed;
    const Hold& longest = *std::ranges::max_element(holds, {}, [](const Hold& h) { return h.end - h.first; });
    // At 15 samples from its end a ramp of this shape is as far off as the noise of one.
    EXPECT_NEAR(static_cast<double>(longest.first), 1000.0, 30.0) << seed;
    EXPECT_NEAR(static_cast<double>(longest.end), 1400.0, 30.0) << seed;
    EXPECT_NEAR(longest.level, 34.0, 4.0 * kNoise_Nm / std::sqrt(380.0)) << seed;
  }
}

TEST(FindHolds, TakesNoSlowRampAndNoSettlingForAHold) {
  std::vector<double> ramp(4000);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = 0.05 * kNoise_Nm * static_cast<double>(i);
  std::vector<double> settling(200, 34.0);
  for (std::size_t i = 0; i < 30; ++i) settling[i] += 2.0 * kNoise_Nm;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    EXPECT_TRUE(FindHolds(WithNoise(ramp, seed), kNoise_Nm).empty()) << seed;
    for (const Hold& hold : FindHolds(WithNoise(settling, seed), kNoise_Nm))
      EXPECT_GE(hold.first, 22U) << seed;
  }
  EXPECT_TRUE(FindHolds(std::vector<double>(200, 34.0), 0.0).empty());
}

// A sine that turns within the noise of a few samples is no plateau: friction keeps its peak.
TEST(FindHolds, TakesNoSlowTurnForAHold) {
  std::vector<double> turn(200);
  for (std::size_t i = 0; i < turn.size(); ++i) {
    const double way = (static_cast<double>(i) - 100.0) / 32.0;
    turn[i] = 34.0 - 2.0 * kNoise_Nm * way * way;
  }
  std::size_t taken = 0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed)
    taken += FindHolds(WithNoise(turn, seed), kNoise_Nm).size();
  EXPECT_LE(taken, 10U);
}

// Stairs of six samples and risers of three; a ramp of the noise a sample has none.
TEST(FindStairs, FindsShortStairsAndNoneOnARamp) {
  std::vector<double> stairs;
  std::vector<double> ramp;
  for (int i = 0; i < 900; ++i) {
    stairs.push_back(30.0 * kNoise_Nm * (i / 9 + std::max(0, i % 9 - 5) / 4.0));
    ramp.push_back(kNoise_Nm * i);
  }
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const std::vector<Hold> found = FindStairs(WithNoise(stairs, seed), kNoise_Nm);
    EXPECT_GE(found.size(), 80U) << seed;
    for (const Hold& stair : found)
      EXPECT_NEAR(stair.level, 30.0 * kNoise_Nm * static_cast<double>(stair.first / 9), 3.0 * kNoise_Nm)
          << seed;
    EXPECT_TRUE(FindStairs(WithNoise(ramp, seed), kNoise_Nm).empty()) << seed;
  }
}

// The turn of a ramp that takes no more than a few times the noise a sample.
TEST(FindStairs, TakesNoSharpTurnForAStair) {
  std::size_t taken = 0;
  for (const double noises_a_sample : {1.0, 2.0, 3.0, 4.0}) {
    std::vector<double> turns;
    for (int i = 0; i < 4000; ++i) turns.push_back(noises_a_sample * kNoise_Nm * std::abs(i % 200 - 100));
    for (std::uint32_t seed = 1; seed <= 20; ++seed)
      taken += FindStairs(WithNoise(turns, seed), kNoise_Nm).size();
  }
  // Of 3200 turns.
  EXPECT_LE(taken, 3U);
}

// Friction keeps the furthest that the torque went: by a ramp that is smoothed past its end, the twist
// of the whole hold would be wrong.
TEST(KeepStill, EndsARampAtTheHold) {
  std::vector<double> time_s(2400);
  for (std::size_t i = 0; i < time_s.size(); ++i) time_s[i] = 0.0024 * static_cast<double>(i);
  std::vector<double> straight(2400);
  for (std::size_t i = 0; i < straight.size(); ++i)
    straight[i] = 34.0 - 3.2 * kNoise_Nm * std::max(0.0, std::abs(static_cast<double>(i) - 1200.0) - 200.3);
  for (const std::vector<double>& truth_Nm : {SmoothRampAndHold(), straight}) {
    double furthest_Nm = 0.0;
    for (std::uint32_t seed = 1; seed <= 50; ++seed) {
      const std::vector<double> torque_Nm = WithNoise(truth_Nm, seed);
      CleanSignal clean = WithoutNoise(time_s, torque_Nm, kNoise_Nm);
      KeepStill(FindHolds(torque_Nm, kNoise_Nm), kNoise_Nm, clean);
      furthest_Nm = std::max(furthest_Nm, std::ranges::max(clean.values) - 34.0);
    }
    EXPECT_LT(furthest_Nm, 0.3 * kNoise_Nm);
  }
}

// The mount creeps while a noisy torque is held, and nothing else does.
TEST(HysteresisHolds, NameCreepAlone) {
  const std::vector<PathLeg> path{{34.0, 1.0, 30.0}, {-34.0, 1.0, 30.0}, {34.0, 1.0, 30.0}, {0.0, 1.0}};
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const Diagnosed found =
        DiagnoseLoop({.friction_Nm = {3.0}, .yield_rad = {0.7e-4}, .creep_s = 4.0, .creep_rad_per_Nm = 3e-7},
                     {.torque_noise_Nm = 0.016, .angle_noise_rad = RadFromArcmin(0.004)}, path, 6000, seed);
    EXPECT_EQ(found.names(), Names{"creep"}) << seed;
  }
}

// Readings of a hold differ by their noise alone: no shape over the output angle.
TEST(HysteresisHolds, LeaveNoShapeOverTheAngle) {
  const std::vector<PathLeg> path{{34.0, 1.0, 30.0}, {-34.0, 1.0, 30.0}, {0.0, 1.0}};
  const Diagnosed clean = DiagnoseLoop({}, {}, path, 4000, 3);
  EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect);
  EXPECT_EQ(clean.diagnosis.residual.signature, "");
}

// Of one loop two passes lie in the window, and a long block held out may hold both.
TEST(HysteresisOneLoop, LeavesADentWithoutAName) {
  const std::vector<PathLeg> path{{34.0, 1.0}, {-34.0, 1.0}, {0.0, 1.0}};
  for (const double middle_Nm : {9.0, 16.0, 17.5}) {
    GeneratedSensors sensors;
    sensors.unlisted_rad = [&](double, double torque_Nm, double, bool) {
      return RadFromArcmin(0.04) * std::exp(-0.5 * std::pow((torque_Nm - middle_Nm) / 0.7, 2));
    };
    const Diagnosed found = DiagnoseLoop({}, sensors, path, 6000, 5);
    EXPECT_EQ(found.diagnosis.verdict, Verdict::kUnnamedStructure) << middle_Nm;
    EXPECT_EQ(found.names(), Names()) << middle_Nm;
  }
}

// A ramp that slows down before it turns, and the turn in a gap: lines through both sides meet beyond it.
TEST(HysteresisGap, TakesASlowTurnNoFurtherThanTheOthers) {
  const std::vector<PathLeg> path = Loops(3, {{30.0, 4.0}, {34.0, 1.0}, {31.0, 0.6}});
  HysteresisData record = GenerateLoop({}, {.torque_noise_Nm = 0.0}, path, 6000, 3);
  // From 29 Nm, on the way up, to 33.2 Nm on the way down from the second loop's peak.
  const auto after = [&](std::size_t i, auto holds) {
    while (!holds(record.torque_Nm[i])) ++i;
    return static_cast<std::ptrdiff_t>(i);
  };
  const std::size_t low = static_cast<std::size_t>(after(0, [](double torque) { return torque < -33.0; }));
  const std::ptrdiff_t first = after(low, [](double torque) { return torque > 29.0; });
  const std::size_t peak = static_cast<std::size_t>(
      after(static_cast<std::size_t>(first), [](double torque) { return torque > 33.9; }));
  const std::ptrdiff_t last = after(peak, [](double torque) { return torque < 33.2; });
  for (std::vector<double>* column : {&record.time_s, &record.torque_Nm, &record.output_angle_rad})
    column->erase(column->begin() + first, column->begin() + last);
  const Diagnosed clean = DiagnoseRecords(&MakeHysteresisStudy, std::vector<HysteresisData>{record});
  EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect) << clean.diagnosis.residual.signature;
  ASSERT_EQ(clean.study->warnings().size(), 1U);
  const std::string& warning = clean.study->warnings()[0];
  EXPECT_TRUE(warning.starts_with("the torque turns back while rows are missing, ")) << warning;
  EXPECT_TRUE(
      warning.ends_with(" s: how far it went is not in the record, 34 Nm is taken, and what friction does "
                        "behind it hangs on that"))
      << warning;
}

// Alone a slip follows the drift by slipping a little further one way, in the form that is best for both;
// beside the drift it is another form's.
TEST(HysteresisPair, LetsASlipChangeItsFormBesideADrift) {
  const std::vector<PathLeg> path{{34.0, 3.8}, {-34.0, 3.8}, {34.0, 3.8}, {-34.0, 3.8}, {0.0, 3.8}};
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    GeneratedSensors sensors{.torque_noise_Nm = 0.0, .angle_noise_rad = RadFromArcmin(0.018)};
    sensors.drift_rad = [](double time_s, double) {
      return -RadFromArcmin(0.03) * -std::expm1(-time_s / 100.0);
    };
    const Diagnosed found =
        DiagnoseLoop({.slip_from_Nm = 20.5, .slip_rad_per_Nms = 4.3e-7}, sensors, path, 4500, seed);
    Names names = found.names();
    std::ranges::sort(names);
    EXPECT_EQ(names, (Names{"brake_slip", "thermal_drift"})) << seed;
  }
}

// A single element is seen at its own time constant alone, wherever that is.
TEST(HysteresisHolds, ShowTheTimeConstantOfASingleElement) {
  const std::vector<PathLeg> path{{34.0, 2.0, 6.0}, {-34.0, 2.0, 6.0}, {34.0, 2.0, 6.0}, {0.0, 2.0}};
  for (const double creep_s : {5.0, 8.0, 10.0, 12.0}) {
    const Diagnosed found = DiagnoseLoop(
        {.friction_Nm = {3.0}, .yield_rad = {0.7e-4}, .creep_s = creep_s, .creep_rad_per_Nm = 5e-7},
        {.torque_noise_Nm = 0.016, .angle_noise_rad = RadFromArcmin(0.006)}, path, 4000, 1);
    EXPECT_EQ(found.names(), Names{"creep"}) << creep_s;
    const ParameterValue time_constant = found.value("time_constant_s");
    EXPECT_NEAR(time_constant.value, creep_s, 0.15 * creep_s);
  }
}

// The torque's steps are coarser than its noise: all samples of a rest are off by the same.
TEST(TorqueSteps, NamesNothingThatIsNoMoreThanTheTorquesSteps) {
  const std::vector<PathLeg> path{{.to_Nm = 34.0},
                                  {.to_Nm = 12.3, .hold_s = 40.0},
                                  {.to_Nm = -34.0},
                                  {.to_Nm = -12.3, .hold_s = 40.0},
                                  {.to_Nm = 34.0}};
  for (const double step_Nm : {0.27, 0.13}) {
    HysteresisData record = GenerateLoop({}, {.angle_noise_rad = RadFromArcmin(0.001)}, path, 1100, 31);
    for (double& torque_Nm : record.torque_Nm) torque_Nm = step_Nm * std::round(torque_Nm / step_Nm);
    const Diagnosed found = DiagnoseRecords(&MakeHysteresisStudy, std::vector{record});
    EXPECT_EQ(found.names(), Names()) << step_Nm;
    EXPECT_EQ(found.diagnosis.verdict, Verdict::kNoEffect) << step_Nm;
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_holds_test
