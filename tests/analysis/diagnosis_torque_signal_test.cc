// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/hysteresis/checks.h"
#include "analysis/diagnosis/hysteresis/noise_reversals.h"
#include "analysis/diagnosis/hysteresis/record.h"
#include "analysis/diagnosis/hysteresis/signal.h"

namespace strainwave::analysis::diagnosis::diagnosis_torque_signal_test {
namespace {

// A ramp of three times its noise a sample that ends in a hold: at the corner and beside it the mean of many
// draws stays on the corner.
TEST(WithoutNoise, LeavesACornerWhereItIs) {
  constexpr std::size_t kCorner = 60;
  constexpr double kNoise_Nm = 0.025;
  constexpr int kDraws = 300;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, kNoise_Nm);
  std::vector<double> time_s(120);
  std::vector<double> truth_Nm(120);
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    time_s[i] = 0.015 * static_cast<double>(i);
    truth_Nm[i] = 0.075 * static_cast<double>(std::min(i, kCorner));
  }
  std::vector<double> mean_error_Nm(5, 0.0);  // two samples either side
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<double> torque_Nm = truth_Nm;
    for (double& value : torque_Nm) value += normal(random);
    const std::vector<double> clean_Nm = WithoutNoise(time_s, torque_Nm, kNoise_Nm).values;
    for (std::size_t k = 0; k < 5; ++k) {
      const std::size_t at = kCorner - 2 + k;
      mean_error_Nm[k] += (clean_Nm[at] - truth_Nm[at]) / kDraws;
    }
  }
  for (const double error_Nm : mean_error_Nm) EXPECT_NEAR(error_Nm, 0.0, 0.25 * kNoise_Nm);
}

// A ramp of three times its noise a sample that turns, and one period of a sine.
TEST(SlopesWithoutNoise, AreThoseOfTheRampsUpToTheirTurnAndOfASine) {
  constexpr std::size_t kTurn = 400;
  constexpr double kNoise_Nm = 0.025;
  constexpr double kStep_s = 0.01;
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, kNoise_Nm);
  std::vector<double> time_s;
  std::vector<double> ramps_Nm;
  std::vector<double> sine_Nm;
  for (std::size_t i = 0; i <= 2 * kTurn; ++i) {
    time_s.push_back(kStep_s * static_cast<double>(i));
    ramps_Nm.push_back(0.075 * static_cast<double>(std::min(i, 2 * kTurn - i)) + normal(random));
    sine_Nm.push_back(10.0 * std::sin(std::numbers::pi * static_cast<double>(i) / kTurn) + normal(random));
  }
  const std::vector<std::size_t> turn{kTurn};
  const std::vector<double> ramps = SlopesWithoutNoise(time_s, ramps_Nm, kNoise_Nm, turn);
  const std::vector<double> sine = SlopesWithoutNoise(time_s, sine_Nm, kNoise_Nm, {});
  // A twentieth of the usual slope is the error asked for: four of them.
  constexpr double kMostError = 4.0 * 0.05;
  constexpr double kSteepest = 10.0 * std::numbers::pi / (kTurn * kStep_s);
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    EXPECT_NEAR(ramps[i], i <= kTurn ? 7.5 : -7.5, kMostError * 7.5) << i;
    if (i < kTurn / 10 || i + kTurn / 10 > time_s.size()) continue;
    EXPECT_NEAR(sine[i], kSteepest * std::cos(std::numbers::pi * static_cast<double>(i) / kTurn),
                kMostError * kSteepest)
        << i;
  }
  EXPECT_EQ(SlopesWithoutNoise(std::vector{0.0, 1.0, 3.0}, std::vector{0.0, 2.0, 4.0}, 0.0, {}),
            (std::vector{2.0, 2.0, 1.0}));
}

// A held load neither creeps back nor forth, whatever its noise; a reversal beyond the noise stays.
TEST(WithoutNoiseReversals, KeepsAHoldWhereItIs) {
  const std::vector<double> values{0.0, 1.0, 2.0, 3.1, 2.95, 3.0, 3.05, 2.92, 2.98, 2.0, 1.0, 0.0};
  const std::vector<double> errors(values.size(), 0.05);
  const std::vector<Branch> branches = SplitBranches(values, 0.5);
  ASSERT_EQ(branches.size(), 2U);
  const std::vector<double> settled = WithoutNoiseReversals(values, errors, 0.2, branches);
  for (std::size_t i = 3; i < 9; ++i) EXPECT_NEAR(settled[i], 3.0, 1e-12) << i;
  EXPECT_EQ(settled[2], 2.0);
  EXPECT_EQ(settled[9], 2.0);
  EXPECT_EQ(WithoutNoiseReversals(values, errors, 0.01, branches), values);
}

// The two samples beside a gap in a ramp stand as far off the mean of their neighbours as half of the gap.
TEST(LoneSpikes, TakesNoGapForASpike) {
  std::vector<double> time_s;
  std::vector<double> torque_Nm;
  for (int i = 0; i < 100; ++i) {
    if (i > 40 && i < 60) continue;
    time_s.push_back(0.1 * i);
    torque_Nm.push_back(0.3 * i + 0.001 * (i % 3));
  }
  EXPECT_TRUE(LoneSpikes(time_s, torque_Nm, 0.01).empty());
  torque_Nm[20] += 1.0;
  EXPECT_EQ(LoneSpikes(time_s, torque_Nm, 0.01), std::vector<std::size_t>{20});
}

// The sample half way up a riser of a stair stands off the line through its neighbours, and is none either;
// one that stands out of a ramp is.
TEST(LoneSpikes, TakesNoRiserForASpike) {
  std::vector<double> time_s;
  std::vector<double> stair_Nm;
  std::vector<double> ramp_Nm;
  for (int i = 0; i < 60; ++i) {
    time_s.push_back(0.1 * i);
    const int level = i / 6;
    stair_Nm.push_back(3.0 * level + (i % 6 == 5 ? 0.3 : 0.0));
    ramp_Nm.push_back(0.5 * i + (i == 30 ? 0.4 : 0.0));
  }
  EXPECT_TRUE(LoneSpikes(time_s, stair_Nm, 0.01).empty());
  EXPECT_EQ(LoneSpikes(time_s, ramp_Nm, 0.01), std::vector<std::size_t>{30});
}

constexpr double kTorqueNoise_Nm = 0.02;

// An angle that follows the torque alone, and has no noise.
struct NoisyLoops {
  std::vector<double> torque_Nm;  // truth
  HysteresisData record;
};

// Three triangles to 34 Nm of 4000 samples.
NoisyLoops TrianglesAt(const std::vector<double>& taken_s, const std::vector<double>& stamped_s) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, kTorqueNoise_Nm);
  NoisyLoops loops;
  loops.record.time_s = stamped_s;
  for (const double time_s : taken_s) {
    const double torque_Nm =
        34.0 * std::asin(std::sin(2.0 * std::numbers::pi * time_s)) * 2.0 / std::numbers::pi;
    loops.torque_Nm.push_back(torque_Nm);
    loops.record.torque_Nm.push_back(torque_Nm + normal(random));
    loops.record.output_angle_rad.push_back(torque_Nm / 2.0e4);
  }
  return loops;
}

double ErrorOfDrivingTorque(const NoisyLoops& loops) {
  const LoopRecords prepared = PrepareLoopRecords(std::span(&loops.record, 1));
  double squares = 0.0;
  for (std::size_t i = 0; i < loops.torque_Nm.size(); ++i) {
    const double error_Nm = prepared.samples.torque_Nm[i] - loops.torque_Nm[i];
    squares += error_Nm * error_Nm;
  }
  return std::sqrt(squares / static_cast<double>(loops.torque_Nm.size()));
}

// Where the samples lie unevenly, torque and angle go to and fro beside a straight line by their numbers,
// both alike, which is no noise that the gear follows.
TEST(DrivingTorque, LosesItsNoiseWhereSamplesAreUneven) {
  constexpr std::size_t kSamples = 4000;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> off(-0.35, 0.35);
  std::vector<double> even_s(kSamples);
  std::vector<double> uneven_s(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    even_s[i] = 3.0 * static_cast<double>(i) / kSamples;
    uneven_s[i] = 3.0 * (static_cast<double>(i) + (i == 0 ? 0.0 : off(random))) / kSamples;
  }
  constexpr double kMostLeft_Nm = 0.4 * kTorqueNoise_Nm;
  EXPECT_LT(ErrorOfDrivingTorque(TrianglesAt(even_s, even_s)), kMostLeft_Nm);
  EXPECT_LT(ErrorOfDrivingTorque(TrianglesAt(uneven_s, uneven_s)), kMostLeft_Nm);
  // Only the stamps are uneven.
  EXPECT_LT(ErrorOfDrivingTorque(TrianglesAt(even_s, uneven_s)), kMostLeft_Nm);
}

// A stair of six samples a step, one of them on the riser: of fourth differences most hold one.
TEST(SampleNoise, OfAStairIsNotItsRisers) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0.0, kTorqueNoise_Nm);
  std::vector<double> time_s;
  std::vector<double> torque_Nm;
  for (int i = 0; i < 480; ++i) {
    time_s.push_back(0.1 * i);
    torque_Nm.push_back(3.4 * (i / 6 + (i % 6 == 5 ? 0.5 : 0.0)) + normal(random));
  }
  // A third of the neighbours differ by half a riser: the median lies where three quarters of the noise do.
  EXPECT_LT(SampleNoise(time_s, torque_Nm), 1.8 * kTorqueNoise_Nm);
}

// Of a stair of three samples a step, one of them on the riser, nothing tells the noise; its upper steps are
// no saturation, over which the angle goes on and comes back.
// Stamps to the microsecond of a torque that has no noise: even steps are smoother. A tenth of a second is
// missing all the same, and the torque's peak in it.
TEST(TimesOfSamples, KeepAGapWhereStampsAreRounded) {
  std::vector<double> time_s;
  std::vector<double> torque_Nm;
  for (int i = 0; i < 4000; ++i) {
    const double at_s = 1.2345678e-3 * i;
    if (at_s > 1.9 && at_s < 2.0) continue;
    time_s.push_back(1e-6 * std::round(1e6 * at_s));
    torque_Nm.push_back(1e-5 * std::round(1e5 * 17.0 * std::min(at_s, 3.9 - at_s)));
  }
  const std::vector<double> times_s = TimesOfSamples(time_s, torque_Nm, torque_Nm);
  for (std::size_t i = 0; i < times_s.size(); ++i) ASSERT_NEAR(times_s[i], time_s[i], 2e-6) << i;
  const std::vector<Turn> turns = FindTurns(times_s, torque_Nm, 1e-5);
  ASSERT_EQ(turns.size(), 1U);
  EXPECT_NEAR(turns.front().value, 17.0 * 1.95, 1e-3);
}

// The torque's noise hides stamps that are off by a twentieth of a step; the angle, which follows it with
// less, does not.
TEST(TimesOfSamples, AreEvenWhereTheAngleShowsThatStampsJitter) {
  std::mt19937 random(23);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> late(-0.08, 0.08);
  std::vector<double> even_s, stamps_s, torque_Nm, angle_rad, uneven_torque_Nm, uneven_angle_rad;
  const auto clean_Nm = [](double time_s) { return 60.0 * std::sin(0.07 * time_s); };
  for (int i = 0; i < 800; ++i) {
    even_s.push_back(0.1 * i);
    stamps_s.push_back(0.1 * (i + (i == 0 || i == 799 ? 0.0 : late(random))));
    const double torque_noise_Nm = 0.08 * normal(random);
    const double angle_noise_rad = 3e-7 * normal(random);
    torque_Nm.push_back(clean_Nm(even_s.back()) + torque_noise_Nm);
    angle_rad.push_back(2e-5 * clean_Nm(even_s.back()) + angle_noise_rad);
    uneven_torque_Nm.push_back(clean_Nm(stamps_s.back()) + torque_noise_Nm);
    uneven_angle_rad.push_back(2e-5 * clean_Nm(stamps_s.back()) + angle_noise_rad);
  }
  const std::vector<double> times_s = TimesOfSamples(stamps_s, torque_Nm, angle_rad);
  for (std::size_t i = 0; i < times_s.size(); ++i) ASSERT_NEAR(times_s[i], even_s[i], 1e-9) << i;
  EXPECT_EQ(TimesOfSamples(stamps_s, uneven_torque_Nm, uneven_angle_rad), stamps_s) << "samples were uneven";
}

TEST(RequireDiagnosableLoop, TakesNoCoarseStairForSaturation) {
  std::mt19937 random(17);
  std::normal_distribution<double> normal(0.0, kTorqueNoise_Nm);
  const auto level = [](int at) { return 2.6 * (at <= 13 ? at : at <= 39 ? 26 - at : at - 52); };
  HysteresisData record;
  for (int i = 0; i < 900; ++i) {
    const int step = i / 3 % 52;
    const double torque_Nm = i % 3 == 2 ? 0.5 * (level(step) + level(step + 1)) : level(step);
    record.time_s.push_back(0.1 * i);
    record.torque_Nm.push_back(torque_Nm + normal(random));
    record.output_angle_rad.push_back(torque_Nm / 2.0e4);
  }
  EXPECT_NO_THROW(RequireDiagnosableLoop(record));
}

// Two loops of stairs with ramps of 9 samples between them, ten times the noise a sample.
std::vector<double> RampedStairs(std::size_t stair) {
  std::vector<double> torque_Nm;
  const auto level = [](int at) {
    return 9.0 * kTorqueNoise_Nm * 10.0 * (at <= 10 ? at : at <= 30 ? 20 - at : at - 40);
  };
  for (int step = 0; step < 80; ++step) {
    const double from_Nm = level(step % 40);
    const double to_Nm = level((step + 1) % 40);
    torque_Nm.insert(torque_Nm.end(), stair, from_Nm);
    for (int i = 1; i < 9; ++i) torque_Nm.push_back(from_Nm + (to_Nm - from_Nm) * i / 9.0);
  }
  return torque_Nm;
}

// The angle goes round every corner of a stair as the torque does; of its noise the gear follows nothing, and
// each stair, however short, is as still as it was.
TEST(DrivingTorque, StandsStillOnShortStairs) {
  for (const std::size_t stair : {12U, 35U}) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal(0.0, kTorqueNoise_Nm);
    NoisyLoops loops;
    loops.torque_Nm = RampedStairs(stair);
    for (std::size_t i = 0; i < loops.torque_Nm.size(); ++i) {
      loops.record.time_s.push_back(0.05 * static_cast<double>(i));
      loops.record.torque_Nm.push_back(loops.torque_Nm[i] + normal(random));
      loops.record.output_angle_rad.push_back(loops.torque_Nm[i] / 2.0e4);
    }
    EXPECT_LT(ErrorOfDrivingTorque(loops), 0.6 * kTorqueNoise_Nm) << stair;
    const LoopRecords prepared = PrepareLoopRecords(std::span(&loops.record, 1));
    double to_and_fro_Nm = 0.0;
    for (std::size_t i = 1; i < loops.torque_Nm.size(); ++i) {
      if (loops.torque_Nm[i] == loops.torque_Nm[i - 1])
        to_and_fro_Nm += std::abs(prepared.samples.torque_Nm[i] - prepared.samples.torque_Nm[i - 1]);
    }
    // Of 160 stairs: some lose a sample at an end.
    EXPECT_LT(to_and_fro_Nm, 80.0 * kTorqueNoise_Nm) << stair;
  }
}

// A noise that the gear follows is torque.
TEST(FollowedShare, IsAllWhereTheResponseFollowsAll) {
  std::mt19937 random(13);
  std::normal_distribution<double> normal(0.0, kTorqueNoise_Nm);
  std::vector<double> time_s;
  std::vector<double> drive_Nm;
  std::vector<double> response_rad;
  const std::vector<double> clean_Nm = RampedStairs(35);
  for (const double clean : clean_Nm) {
    time_s.push_back(0.05 * static_cast<double>(time_s.size()));
    drive_Nm.push_back(clean + normal(random));
    response_rad.push_back(drive_Nm.back() / 2.0e4);
  }
  EXPECT_NEAR(FollowedShare(time_s, drive_Nm, clean_Nm, response_rad, 1.0 / 2.0e4), 1.0, 1e-9);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_torque_signal_test
