// SPDX-License-Identifier: Apache-2.0
#include "analysis/loop_branches.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "analysis/noise_level.h"
#include "tests/analysis/chance.h"

namespace strainwave::analysis::loop_branches_test {
namespace {

TEST(SplitBranches, CutsAtEveryReversalOfAPolygon) {
  const std::vector<double> signal = {0, 1, 2, 3, 2, 1, 0, -1, 0, 1};
  const std::vector<Branch> expected = {{0, 3, true}, {3, 7, false}, {7, 9, true}};
  EXPECT_EQ(SplitBranches(signal, 0.0), expected);
}

TEST(SplitBranches, DoesNotCutAtWigglesBelowTheThreshold) {
  const std::vector<double> signal = {0, 1, 0.8, 2, 1.7, 3, 2, 2.1, 1};
  const std::vector<Branch> expected = {{0, 5, true}, {5, 8, false}};
  EXPECT_EQ(SplitBranches(signal, 0.5), expected);
}

TEST(SplitBranches, TakesAConstantSignalForOneBranch) {
  const std::vector<double> signal = {1, 1, 1};
  EXPECT_EQ(SplitBranches(signal, 0.0), (std::vector<Branch>{{0, 2, true}}));
}

TEST(MonotoneWithinBranches, ReturnsMonotoneSignalsBitForBit) {
  const std::vector<double> signal = {0.1, 0.30000000000000004, 0.7, 0.2, -0.5, -0.5, 0.9};
  EXPECT_EQ(MonotoneWithinBranches(signal, SplitBranches(signal, 0.0)), signal);
}

TEST(MonotoneWithinBranches, PoolsWhatIsOutOfOrder) {
  const std::vector<double> signal = {0, 2, 1, 3};
  const std::vector<Branch> one = {{0, 3, true}};
  EXPECT_EQ(MonotoneWithinBranches(signal, one), (std::vector<double>{0, 1.5, 1.5, 3}));
}

TEST(TwistAtTorque, ReadsAStraightBranchExactlyAndKnowsItsEnds) {
  std::vector<double> torque_Nm;
  std::vector<double> twist_rad;
  for (int i = 0; i <= 100; ++i) {
    torque_Nm.push_back(0.1 * i);
    twist_rad.push_back(2.0 + 0.3 * torque_Nm.back());
  }
  const Branch branch{0, 100, true};
  EXPECT_NEAR(TwistAtTorque(torque_Nm, twist_rad, branch, 5.03, 0.5, 0.0)->value, 2.0 + 0.3 * 5.03, 1e-12);
  EXPECT_FALSE(TwistAtTorque(torque_Nm, twist_rad, branch, 10.2, 0.5, 0.1));
  EXPECT_NEAR(TwistAtTorque(torque_Nm, twist_rad, branch, 10.2, 0.5, 0.3)->value, 2.0 + 0.3 * 10.2, 1e-12);
}

TEST(TwistAtTorque, TakesTheSlopeOfAStaircaseFromItsNextSteps) {
  // Holds of five samples, 6 Nm apart, at torques that are not quite the same.
  std::vector<double> torque_Nm;
  std::vector<double> twist_rad;
  for (int step = -3; step <= 3; ++step) {
    for (int i = 0; i < 5; ++i) {
      torque_Nm.push_back(6.0 * step + 0.004 + 1e-9 * i);
      twist_rad.push_back(2.0 + 0.3 * torque_Nm.back() + (i % 2 == 0 ? 1e-3 : -1e-3));
    }
  }
  const Branch branch{0, torque_Nm.size() - 1, true};
  const auto twist = TwistAtTorque(torque_Nm, twist_rad, branch, 0.0, 0.5, 0.0);
  // Of five samples three are above and two below by 1e-3: so is each hold's mean, by a fifth of it.
  EXPECT_NEAR(twist->value, 2.0 + 1e-3 / 5.0, 1e-6);
  // A line through 15 of them, with 13 degrees of freedom, at their middle: 0.96 (1e-3)² · 15 / 13 / 15.
  EXPECT_NEAR(twist->standard_error, 1e-3 * std::sqrt(0.96 / 13.0), 1e-6);
  // One hold alone says nothing of other torques.
  EXPECT_FALSE(TwistAtTorque(torque_Nm, twist_rad, Branch{15, 19, true}, 0.0, 0.5, 1.0));
}

// A segment of a rising branch is not there, or its reversal and with it the rest of the branch before: what
// lies on either side of the gap says nothing of the twist within.
TEST(TwistAtTorque, SaysNothingWhereTheBranchHasNoSamples) {
  std::vector<double> torque_Nm;
  std::vector<double> twist_rad;
  for (int i = -80; i <= 80; ++i) {
    if (i > -15 && i < 22) continue;
    torque_Nm.push_back(0.1 * i);
    twist_rad.push_back(0.3 * torque_Nm.back() + (i < 0 ? 0.5 : 0.0));
  }
  const Branch branch{0, torque_Nm.size() - 1, true};
  EXPECT_FALSE(TwistAtTorque(torque_Nm, twist_rad, branch, 0.0, 0.4, 0.0));
  EXPECT_NEAR(TwistAtTorque(torque_Nm, twist_rad, branch, 4.0, 0.4, 0.0)->value, 1.2, 1e-12);
}

TEST(EstimateNoise, SeesTheNoiseOnARampAndNotTheRamp) {
  std::mt19937 engine(1);
  std::normal_distribution<double> normal(0.0, 0.5);
  std::vector<double> signal;
  for (int i = 0; i < 20000; ++i) {
    signal.push_back(3.0 * std::abs(i - 10000) + normal(engine));
  }
  // A median of |x| is 1.65 times as uncertain as the root of the mean square, and second differences have
  // 0.4 independent values a sample.
  EXPECT_NEAR(EstimateNoise(signal).standard_deviation, 0.5,
              kByChance * 1.65 * SpreadOfDeviation(0.4 * 20000.0) * 0.5);
}

TEST(EstimateNoise, SeesTheStepOfAQuantisedSignal) {
  std::vector<double> signal;
  for (int i = 0; i < 1000; ++i) {
    signal.push_back(0.25 * std::round(0.01 * i / 0.25));
  }
  EXPECT_DOUBLE_EQ(EstimateNoise(signal).step, 0.25);
}

TEST(FindSpikes, FindsThemAndNothingElse) {
  std::mt19937 engine(1);
  constexpr double kNoise = 0.1;
  std::normal_distribution<double> normal(0.0, kNoise);
  std::vector<double> signal;
  for (int i = 0; i < 2000; ++i) {
    signal.push_back(0.01 * std::abs(i - 1000) + normal(engine));
  }
  signal[300] += 2.0;
  signal[301] += 2.0;
  signal[1000] -= 3.0;
  signal[1999] += 2.0;
  const std::vector<std::size_t> spikes = FindSpikes(signal, EstimateNoise(signal));
  EXPECT_EQ(spikes, (std::vector<std::size_t>{300, 301, 1000, 1999}));
  InterpolateOver(signal, spikes);
  EXPECT_NEAR(signal[300], 7.0, kByChance * kNoise) << "by a line between two neighbours, with their noise";
  EXPECT_NEAR(signal[1000], 0.01, kByChance * kNoise / std::sqrt(2.0)) << "the mean of both, beside the tip";
  EXPECT_EQ(signal[1999], signal[1998]);
}

TEST(FindSpikes, LeavesTheTipsOfATriangleAlone) {
  std::vector<double> signal;
  for (int i = 0; i < 100; ++i) {
    signal.push_back(std::abs(i - 50));
  }
  EXPECT_TRUE(FindSpikes(signal, EstimateNoise(signal)).empty());
}

// To look for one in an order ran out of the values, where there are enough of them.
TEST(Median, OfValuesWithANaNIsNone) {
  std::vector<double> values(1000, std::nan(""));
  for (std::size_t i = 0; i < values.size(); i += 3) values[i] = static_cast<double>(i);
  EXPECT_TRUE(std::isnan(Median(values)));
  EXPECT_EQ(FindSpikes(values, {}), std::vector<std::size_t>{});
}

}  // namespace
}  // namespace strainwave::analysis::loop_branches_test
