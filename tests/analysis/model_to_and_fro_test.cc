// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/to_and_fro.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/model/ringing_mode.h"

namespace strainwave::analysis::model::model_to_and_fro_test {
namespace {

TEST(ToAndFro, AddsUpItsOwnSpeeds) {
  // A long stroke with a plateau, and a short one that turns round before full speed.
  for (const double stroke_rad : {4.7, 0.4}) {
    const ToAndFro motion{
        .stroke_rad = stroke_rad, .top_speed_rad_per_s = 3.0, .acceleration_rad_per_s2 = 12.0, .rest_s = 0.1};
    constexpr double kStep_s = 1e-5;
    double angle_rad = 0.0;
    double most_rad = 0.0;
    double fastest_rad_per_s = 0.0;
    for (double time_s = 0.0; time_s < 1.2 * motion.Period_s(); time_s += kStep_s) {
      const JointState state = motion.At(time_s + 0.5 * kStep_s);
      ASSERT_NEAR(motion.At(time_s).angle_rad, angle_rad, 1e-4) << time_s;
      angle_rad += kStep_s * state.speed_rad_per_s;
      most_rad = std::max(most_rad, state.angle_rad);
      fastest_rad_per_s = std::max(fastest_rad_per_s, std::abs(state.speed_rad_per_s));
    }
    EXPECT_NEAR(most_rad, stroke_rad, 1e-6);
    EXPECT_NEAR(fastest_rad_per_s, std::min(3.0, std::sqrt(12.0 * stroke_rad)), 1e-3);
  }
}

TEST(RingingMode, RingsAsTheClosedFormSays) {
  constexpr double kRate_hz = 4000.0;
  constexpr double kMode_Hz = 310.0;
  constexpr double kDamping = 0.03;
  RingingMode mode(kMode_Hz, kDamping, kRate_hz);
  const double omega = 2.0 * std::numbers::pi * kMode_Hz;
  for (int i = 0; i < 200; ++i) {
    const double time_s = i / kRate_hz;
    const double expected = std::exp(-kDamping * omega * time_s) *
                            std::sin(omega * std::sqrt(1.0 - kDamping * kDamping) * time_s);
    EXPECT_NEAR(mode.Step(i == 0 ? 1.0 : 0.0), expected, 1e-10) << i;
  }
}

// Gain at a frequency, from the transform of the response to an impulse.
double GainOf(ButterworthLowPass filter, double frequency_Hz, double rate_hz) {
  std::complex<double> sum;
  for (int i = 0; i < 4000; ++i)
    sum += filter.Step(i == 0 ? 1.0 : 0.0) *
           std::polar(1.0, -2.0 * std::numbers::pi * frequency_Hz * i / rate_hz);
  return std::abs(sum);
}

TEST(ButterworthLowPass, HalvesThePowerAtItsCutoff) {
  constexpr double kRate_hz = 16496.0;
  for (const int order : {2, 4, 8}) {
    const ButterworthLowPass filter(order, 412.4, kRate_hz);
    EXPECT_NEAR(GainOf(filter, 0.0, kRate_hz), 1.0, 1e-9);
    EXPECT_NEAR(GainOf(filter, 412.4, kRate_hz), std::sqrt(0.5), 1e-6);
    // Far above, an order n falls by 6 n dB an octave; the bilinear transform by a little more.
    EXPECT_LT(GainOf(filter, 824.8, kRate_hz), std::pow(0.5, order) * 1.02);
  }
}

TEST(ButterworthLowPass, RefusesOddOrdersAndCutoffsBeyondNyquist) {
  for (const auto& [order, cutoff_Hz] : {std::pair{3, 100.0}, {0, 100.0}, {4, 500.0}, {4, 0.0}})
    EXPECT_THROW(ButterworthLowPass(order, cutoff_Hz, 1000.0), std::invalid_argument);
}

}  // namespace
}  // namespace strainwave::analysis::model::model_to_and_fro_test
