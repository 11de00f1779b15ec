// SPDX-License-Identifier: Apache-2.0
#include "analysis/amplitude_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace strainwave::analysis::amplitude_spectrum_test {
namespace {

constexpr double kRate_Hz = 1024.0;

std::vector<double> Sine(double frequency_Hz, double amplitude, std::size_t samples) {
  std::vector<double> values(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    values[i] =
        5.0 + amplitude * std::sin(2.0 * std::numbers::pi * frequency_Hz * static_cast<double>(i) / kRate_Hz);
  }
  return values;
}

TEST(AmplitudeSpectrum, HasASineWithItsAmplitudeAtItsFrequency) {
  const auto spectrum = AmplitudeSpectrumOf(Sine(100.0, 2.0, 4096), kRate_Hz, 1024);
  ASSERT_EQ(spectrum.frequency_Hz.size(), 513U);
  const auto at = static_cast<std::size_t>(std::ranges::max_element(spectrum.amplitude) - spectrum.amplitude.begin());
  EXPECT_EQ(spectrum.frequency_Hz[at], 100.0);
  EXPECT_NEAR(spectrum.amplitude[at], 2.0, 1e-9);
  EXPECT_NEAR(spectrum.amplitude[0], 0.0, 1e-9) << "without the mean";
}

TEST(AmplitudeSpectrum, LosesLittleBetweenTwoFrequencies) {
  const auto spectrum = AmplitudeSpectrumOf(Sine(100.5, 2.0, 4096), kRate_Hz, 1024);
  EXPECT_GT(*std::ranges::max_element(spectrum.amplitude), 0.84 * 2.0);  // 8 / (3 pi) = 0.849 for Hann
}

// White noise of deviation s gives 4 s² · 1.5 / n on average: segments of n samples, 1.5 the noise bandwidth of Hann.
TEST(AmplitudeSpectrum, HasTheLevelOfNoise) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, 3.0);
  std::vector<double> values(1 << 17);
  for (double& value : values) value = normal(random);
  const auto spectrum = AmplitudeSpectrumOf(values, kRate_Hz, 1024);
  double mean = 0.0;
  for (std::size_t k = 5; k < 500; ++k) mean += spectrum.amplitude[k] * spectrum.amplitude[k] / 495.0;
  EXPECT_NEAR(mean, 9.0 * 4.0 * 1.5 / 1024.0, 0.02 * mean);
}

TEST(AmplitudeSpectrum, OfFewSamplesIsShorterOrEmpty) {
  EXPECT_EQ(AmplitudeSpectrumOf(Sine(100.0, 1.0, 100), kRate_Hz, 1024).amplitude.size(), 33U);
  EXPECT_TRUE(AmplitudeSpectrumOf(Sine(100.0, 1.0, 7), kRate_Hz, 1024).amplitude.empty());
}

}  // namespace
}  // namespace strainwave::analysis::amplitude_spectrum_test
