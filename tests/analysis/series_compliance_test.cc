// SPDX-License-Identifier: Apache-2.0
#include "analysis/series_compliance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "analysis/units.h"
#include "tests/analysis/chance.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::series_compliance_test {
namespace {

constexpr double kCompliance_rad_per_Nm = 1.0 / 4e4 + 1.0 / 3e4;

TEST(FitSeriesCompliance, ItsErrorCoversTheTruth) {
  int held = 0;
  constexpr int kTrials = 300;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    std::vector<double> torque_Nm;
    std::vector<double> twist_rad;
    double noise = 0.0;
    for (int i = 0; i < 800; ++i) {
      noise = 0.6 * noise + RadFromArcsec(0.3) * normal(engine);
      torque_Nm.push_back(34.0 * std::sin(kTwoPi * i / 800.0));
      twist_rad.push_back(0.2 + kCompliance_rad_per_Nm * torque_Nm.back() + noise);
    }
    const Estimate value = FitSeriesCompliance(torque_Nm, twist_rad).compliance.compliance_rad_per_Nm;
    held += std::abs(value.value - kCompliance_rad_per_Nm) < 1.96 * value.standard_error ? 1 : 0;
  }
  ExpectCoverageOf95(held, kTrials);
}

TEST(FitSeriesCompliance, SaysWhenTheRampIsNone) {
  std::vector<double> torque_Nm(20, 5.0);
  std::vector<double> twist_rad(20, 0.1);
  EXPECT_EQ(FitSeriesCompliance(torque_Nm, twist_rad).failed_checks,
            std::vector<std::string>{"the torque does not change"});
  for (std::size_t i = 0; i < 20; ++i) {
    torque_Nm[i] = static_cast<double>(i);
    twist_rad[i] = -1e-5 * static_cast<double>(i);
  }
  EXPECT_EQ(FitSeriesCompliance(torque_Nm, twist_rad).failed_checks,
            std::vector<std::string>{"twist falls with torque: a sign is swapped"});
}

TEST(FitEncoderError, RecoversEccentricityAndTiltSoThatTheyCanBeTakenOff) {
  std::mt19937 engine(6);
  std::normal_distribution<double> normal;
  std::vector<double> encoder_rad;
  std::vector<double> reference_rad;
  for (int i = 0; i < 360; ++i) {
    const double angle = RadFromDeg(i);
    const double error =
        RadFromArcsec(82.0) * std::cos(angle - 0.5) + RadFromArcsec(4.0) * std::cos(2.0 * angle + 1.0);
    encoder_rad.push_back(angle);
    reference_rad.push_back(angle - error + 0.01 + RadFromArcsec(0.5) * normal(engine));
  }
  const EncoderError error = FitEncoderError(encoder_rad, reference_rad);
  EXPECT_NEAR(ArcsecFromRad(error.once.amplitude.value), 82.0,
              kByChance * ArcsecFromRad(error.once.amplitude.standard_error));
  EXPECT_NEAR(ArcsecFromRad(error.twice.amplitude.value), 4.0,
              kByChance * ArcsecFromRad(error.twice.amplitude.standard_error));
  const double expected_arcsec = 0.5 * std::sqrt(2.0 / 360.0);  // of an amplitude, of a noise of 0.5 arcsec
  EXPECT_NEAR(ArcsecFromRad(error.once.amplitude.standard_error), expected_arcsec,
              kByChance * SpreadOfDeviation(355.0) * expected_arcsec);
  constexpr double kMostOf360 = 4.8;  // standard deviations that one of 360 exceeds once in a thousand
  for (std::size_t i = 0; i < encoder_rad.size(); ++i) {
    EXPECT_NEAR(encoder_rad[i] - error.At(encoder_rad[i]) - reference_rad[i], -0.01,
                kMostOf360 * RadFromArcsec(0.5));
  }
}

TEST(FitEncoderError, WantsATurn) {
  std::vector<double> angle_rad;
  for (int i = 0; i < 90; ++i) {
    angle_rad.push_back(RadFromDeg(i));
  }
  EXPECT_EQ(MessageOf([&] { FitEncoderError(angle_rad, angle_rad); }),
            "encoder_angle_rad covers 89 deg (expected nine tenths of a turn)");
}

}  // namespace
}  // namespace strainwave::analysis::series_compliance_test
