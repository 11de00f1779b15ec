// SPDX-License-Identifier: Apache-2.0
// Sweeps that are sampled in time: rows lie closer together wherever the output is slow. The truth is an
// integral over the angle, by another rule than the one under test.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "analysis/transmission_error.h"
#include "analysis/units.h"

namespace strainwave::analysis::transmission_error_uneven_test {
namespace {

constexpr double kRatio = 80.0;
constexpr double kNoise_rad = RadFromArcmin(0.005);

double Error_rad(double output_rad) {
  return RadFromArcmin(0.8 * std::cos(output_rad - 0.4) + 0.3 * std::cos(2.0 * output_rad) +
                       0.25 * std::cos(2.0 * kRatio * output_rad));
}

struct Sweep {
  std::vector<double> input_rad;
  std::vector<double> output_rad;
  AngleSweep View() const { return {input_rad, output_rad}; }
};

// Rows of a turn at equal times; `speed` by the angle, 0 to 1 of the largest.
Sweep InTime(double way, int standing_first, const std::function<double(double turn)>& speed) {
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  Sweep sweep;
  const auto add = [&](double output_rad) {
    sweep.output_rad.push_back(output_rad);
    sweep.input_rad.push_back(kRatio * (output_rad + Error_rad(output_rad) + kNoise_rad * normal(random)));
  };
  for (int i = 0; i < standing_first; ++i) add(0.0);
  double turn = 0.0;
  for (double since = 0.0; turn < 1.0; since += 1.0) {
    if (since >= 20.0 || turn == 0.0) add(way * kTwoPi * turn), since = 0.0;
    turn += 0.25 / 360.0 / 20.0 * speed(turn);
  }
  return sweep;
}

double Truth_rad() {
  double sum = 0.0;
  for (int i = 0; i < 100000; ++i) sum += Error_rad(kTwoPi * (i + 0.5) / 100000.0);
  return sum / 100000.0;
}

TEST(UnevenSweep, HasTheMeanOverTheAngleHoweverItWasDriven) {
  const auto even = [](double) { return 1.0; };
  const auto slow_quarter = [](double turn) { return turn > 0.5 && turn < 0.75 ? 0.06 : 1.0; };
  const auto ramps = [](double turn) { return 0.05 + 0.95 * std::pow(std::sin(kPi * turn), 2); };
  struct Drive {
    int standing_first;
    std::function<double(double)> speed;
  };
  for (const double way : {1.0, -1.0}) {
    double e_max_rad = 0.0;
    for (const Drive& drive :
         {Drive{0, even}, Drive{500, even}, Drive{0, slow_quarter}, Drive{9000, ramps}}) {
      const Sweep sweep = InTime(way, drive.standing_first, drive.speed);
      const TransmissionError result = way > 0.0 ? ComputeTransmissionError(sweep.View(), {}, kRatio)
                                                 : ComputeTransmissionError({}, sweep.View(), kRatio);
      const SweepError& error = way > 0.0 ? *result.cw : *result.ccw;
      EXPECT_EQ(result.failed_checks, std::vector<std::string>{});
      // Within five of its standard errors, and far within the 0.1' by which the mean over rows is off.
      EXPECT_NEAR(error.e_avg_rad.value, Truth_rad(), 5.0 * error.e_avg_rad.standard_error);
      EXPECT_LT(ArcminFromRad(error.e_avg_rad.standard_error), 0.002);
      if (e_max_rad == 0.0) e_max_rad = error.e_max_rad.value;
      EXPECT_NEAR(ArcminFromRad(error.e_max_rad.value), ArcminFromRad(e_max_rad), 0.05);
    }
  }
}

TEST(UnevenSweep, HasTheLostMotionOverTheAngleToo) {
  // Lost motion that changes over the turn: 0.2' on average, more where the sweep is slow.
  const auto slow = [](double turn) { return turn < 0.25 ? 0.04 : 1.0; };
  const Sweep cw = InTime(1.0, 0, slow);
  Sweep ccw = InTime(-1.0, 300, slow);
  for (std::size_t i = 0; i < ccw.output_rad.size(); ++i) {
    ccw.output_rad[i] += kTwoPi;
    ccw.input_rad[i] = kRatio * (ccw.output_rad[i] + Error_rad(ccw.output_rad[i]) -
                                 RadFromArcmin(0.2 + 0.15 * std::sin(ccw.output_rad[i])));
  }
  const TransmissionError result = ComputeTransmissionError(cw.View(), ccw.View(), kRatio);
  ASSERT_TRUE(result.lost_motion_rad);
  EXPECT_NEAR(ArcminFromRad(result.lost_motion_rad->value), 0.2, 0.003);
}

// The wave generator's second harmonic turns by more than half a period from row to row, in the slow part by
// less: it folds to no one order.
TEST(UnevenSweep, HasTheSecondHarmonicThatItsStepsFold) {
  std::mt19937 random(23);
  std::normal_distribution<double> normal;
  for (const double slow : {0.3, 0.55, 0.8}) {
    Sweep sweep;
    for (double turn = 0.0; turn < 1.0; turn += (turn > 0.4 && turn < 0.7 ? slow : 1.0) * 2.6 / 360.0) {
      sweep.output_rad.push_back(kTwoPi * turn);
      sweep.input_rad.push_back(kRatio *
                                (kTwoPi * turn + Error_rad(kTwoPi * turn) + kNoise_rad * normal(random)));
    }
    const TransmissionError result = ComputeTransmissionError(sweep.View(), {}, kRatio);
    const auto second = std::ranges::find(result.cw->orders, 2.0 * kRatio, &OrderLine::order_per_output_rev);
    ASSERT_NE(second, result.cw->orders.end()) << slow;
    EXPECT_NEAR(ArcminFromRad(second->amplitude_rad.value), 0.25, 0.01) << slow;
    EXPECT_FALSE(second->aliased) << slow;
  }
}

TEST(UnevenSweep, CountsItsStepsAndSeesWhatIsLeftOut) {
  Sweep twelve;
  for (int i = 0; i <= 12; ++i) {
    for (int k = 0; k < 10; ++k) {  // ten readings a step
      twelve.output_rad.push_back(RadFromDeg(30.0 * i));
      twelve.input_rad.push_back(kRatio * (twelve.output_rad.back() + Error_rad(twelve.output_rad.back())));
    }
  }
  EXPECT_EQ(ComputeTransmissionError(twelve.View(), {}, kRatio).failed_checks,
            std::vector<std::string>{"cw: 12 steps in the revolution (expected at least 36)"});
  Sweep hole = InTime(1.0, 0, [](double) { return 1.0; });
  hole.output_rad.erase(hole.output_rad.begin() + 400, hole.output_rad.begin() + 500);
  hole.input_rad.erase(hole.input_rad.begin() + 400, hole.input_rad.begin() + 500);
  const auto checks = ComputeTransmissionError(hole.View(), {}, kRatio).failed_checks;
  ASSERT_EQ(checks.size(), 1U);
  EXPECT_TRUE(checks[0].starts_with("cw: the sweep leaves out 25")) << checks[0];
  EXPECT_TRUE(checks[0].ends_with("deg (expected steps of 15 deg at most)")) << checks[0];
}

TEST(UnevenSweep, ShowsOneBadSampleAndNoDamagedTooth) {
  Sweep sweep = InTime(1.0, 0, [](double) { return 1.0; });
  const auto checks = [&] { return ComputeTransmissionError(sweep.View(), {}, kRatio).failed_checks; };
  EXPECT_EQ(checks(), std::vector<std::string>{});
  for (std::size_t i = 0; i < sweep.output_rad.size(); ++i) {
    const double off = (sweep.output_rad[i] - 2.0) / RadFromDeg(0.8);
    sweep.input_rad[i] += kRatio * RadFromArcmin(0.5) * std::exp(-0.5 * off * off);
  }
  EXPECT_EQ(checks(), std::vector<std::string>{});
  sweep.input_rad[700] += kRatio * RadFromArcmin(1.0);
  const auto found = checks();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].starts_with("cw: sample 700 at ")) << found[0];
}

}  // namespace
}  // namespace strainwave::analysis::transmission_error_uneven_test
