// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "analysis/diagnosis/vibration/impulse_train.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/units.h"
#include "tests/analysis/vibration_record.h"

// Bearings whose balls slip: each impulse comes by a part of the period early or late, and all that follow
// with it.
namespace strainwave::analysis::diagnosis::diagnosis_slipping_test {
namespace {

constexpr double kOrder = 7.63;
constexpr double kResonance_Hz = 1130.0;
constexpr double kDamping = 0.06;

Effect SlippingBearing(unsigned seed, double slip, double height, double change = 0.0) {
  return [=](const Turning& run) {
    std::mt19937 random(seed);
    std::normal_distribution<double> slips(0.0, slip);
    Signal signal = Silence(run);
    std::size_t i = 0;
    for (double impact = 0.4; impact < run.turns() * kOrder; impact += 1.0 + slips(random)) {
      const double angle = impact * kTwoPi / kOrder;
      while (i + 2 < run.angle_rad.size() && run.angle_rad[i + 1] < angle) ++i;
      const double share = (angle - run.angle_rad[i]) / (run.angle_rad[i + 1] - run.angle_rad[i]);
      const double zones = 1.0 + change * std::cos(angle + 0.3);
      AddRinging(run, (static_cast<double>(i) + share) / kRate_Hz, height * zones, kResonance_Hz, kDamping,
                 signal);
    }
    return signal;
  };
}

TEST(SlippingBearing, IsNamedWithItsOrderAndNoResonanceBesideIt) {
  for (const unsigned seed : {81U, 82U, 83U}) {
    for (const double slip : {0.01, 0.02}) {
      const Effect bearing = SlippingBearing(seed, slip, 0.6);
      const Diagnosed answer = Ask({Record(Turning(1500.0, 1.0, 0.0), seed, bearing, {1.0, -0.6})});
      EXPECT_EQ(answer.names(), Names{"bearing_defect"}) << seed << ", " << slip;
      if (answer.names() != Names{"bearing_defect"}) continue;
      const ParameterValue order = answer.value("defect_order");
      EXPECT_NEAR(order.value, kOrder, 4.0 * order.standard_error);
      EXPECT_LT(order.standard_error, 0.02);
      EXPECT_NEAR(answer.value("ring_Hz").value, kResonance_Hz, 40.0);
      EXPECT_NEAR(answer.value("slip_share").value, slip, 0.5 * slip);
    }
  }
}

// A gap of four impulses: those that are not observable are counted, or the order would be another one.
TEST(SlippingBearing, IsNamedWithItsOrderOverAGap) {
  const Effect bearing = SlippingBearing(89, 0.01, 0.7);
  VibrationData record = Record(Turning(1500.0, 1.0, 0.0), 89, bearing, {1.0, -0.6});
  const auto cut_out = [](std::vector<double>& values) {
    values.erase(values.begin() + 2000, values.begin() + 2110);
  };
  cut_out(record.time_s);
  for (VibrationChannel& channel : record.channels) cut_out(channel.values);
  const Diagnosed answer = Ask({record});
  ASSERT_EQ(answer.names(), Names{"bearing_defect"});
  const ParameterValue order = answer.value("defect_order");
  EXPECT_NEAR(order.value, kOrder, 4.0 * order.standard_error);
}

TEST(SlippingBearing, IsNamedWhereItsImpulsesChangeWithTheLoad) {
  const Effect bearing = SlippingBearing(84, 0.02, 0.8, 0.8);
  const Diagnosed answer = Ask({Record(Turning(1500.0, 1.0, 0.0), 84, bearing)});
  ASSERT_EQ(answer.names(), Names{"bearing_defect"});
  EXPECT_EQ(answer.value("modulated_per_turn").value, 1.0);
}

// The resonance that noise drives is large now and then, but not so many times a turn.
TEST(SlippingBearing, IsNoneWhereNoiseDrivesAResonance) {
  for (const unsigned seed : {85U, 86U}) {
    const Effect resonance = [seed](const Turning& run) {
      std::mt19937 random(seed);
      std::normal_distribution<double> height(0.0, 0.05);
      Signal signal = Silence(run);
      for (double start_s = 0.0; start_s < run.time_s.back(); start_s += 0.0002)
        AddRinging(run, start_s, height(random), kResonance_Hz, 0.02, signal);
      return signal;
    };
    const Diagnosed answer = Ask({Record(Turning(1500.0, 1.0, 0.0), seed, resonance)});
    ASSERT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure) << seed;
    EXPECT_EQ(answer.study->causes()[answer.diagnosis.nuisance_terms.front().index].name,
              "resonance of the structure")
        << seed;
  }
}

TEST(ImpulseTrainColumn, BeginsEachResponseWhereItsImpulseSlippedTo) {
  const Turning turning(1500.0, 0.2, 0.1);
  const VibrationData record = Record(turning, 87, Silence);
  const VibrationRun run = PrepareVibration({&record, 1}).runs.front();
  ImpulseTrain train{3.0, 400.0, 0.1, 0.25, {}, {}};
  std::mt19937 random(88);
  std::uniform_real_distribution<double> slip(-0.1, 0.1);
  for (int j = -10; j <= 10; ++j) train.slips.push_back(slip(random));
  const Eigen::VectorXd column = ImpulseTrainColumn(run, train);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(column.size());
  for (int j = -10; j <= 10; ++j) {
    const double place = j + train.phase + train.slips[static_cast<std::size_t>(j + 10)];
    const double angle_rad = place * kTwoPi / train.order + 0.5 * run.angle_rad.back();
    const auto after = std::ranges::upper_bound(run.angle_rad, angle_rad) - run.angle_rad.begin();
    if (after == 0 || after == column.size()) continue;
    const auto i = static_cast<std::size_t>(after);
    const double share = (angle_rad - run.angle_rad[i - 1]) / (run.angle_rad[i] - run.angle_rad[i - 1]);
    AddTransient(run, train.resonance_Hz, train.damping_ratio,
                 run.time_s[i - 1] + share * (run.time_s[i] - run.time_s[i - 1]), 1.0, expected);
  }
  // What rang before the record began has died away.
  const Eigen::Index quiet = column.size() / 4;
  EXPECT_LT((column - expected).tail(column.size() - quiet).cwiseAbs().maxCoeff(), 1e-3);
}

// Even steps of which a file keeps but microseconds, and a gap.
TEST(AddTransient, RingsOnOverTimeStampsOfFewDigits) {
  VibrationRun run;
  run.period_s = 1.0 / 5120.0;
  for (int i = 0; i < 400; ++i)
    run.time_s.push_back(1e-6 * std::round(1e6 * (i < 200 ? i : i + 30) * run.period_s));
  constexpr double kStart_s = 0.01013;
  Eigen::VectorXd column = Eigen::VectorXd::Zero(400);
  AddTransient(run, kResonance_Hz, 0.01, kStart_s, 2.0, column);
  const std::complex<double> pole = ResonancePole(kResonance_Hz, 0.01);
  for (int i = 0; i < 400; ++i) {
    const double since_s = run.time_s[static_cast<std::size_t>(i)] - kStart_s;
    const double expected =
        since_s < 0.0 ? 0.0 : 2.0 * std::exp(pole.real() * since_s) * std::sin(pole.imag() * since_s);
    EXPECT_NEAR(column(i), expected, 1e-11) << i;
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_slipping_test
