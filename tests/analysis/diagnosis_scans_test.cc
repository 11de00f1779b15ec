// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis::diagnosis_scans_test {
namespace {

TEST(FindLines, FindsAnOrderAmongUnevenSamplesAndRefinesIt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 4.0 * kPi);
  std::vector<double> angle;
  std::vector<double> residual;
  const std::vector<double> noise = WhiteNoise(900, 0.5, 4);
  for (std::size_t i = 0; i < 900; ++i) {
    angle.push_back(uniform(random));
    residual.push_back(1.7 + 0.3 * std::cos(37.4 * angle.back() - 1.0) + noise[i]);
  }
  const std::vector<double> weights(900, 1.0);
  const auto peaks = FindLines(angle, residual, weights, 0.5, 200.0, 2);
  ASSERT_EQ(peaks.size(), 2u);
  // Three standard deviations of the order: sqrt(24 / n) · sd / amplitude / span = 0.022.
  EXPECT_NEAR(peaks[0].order, 37.4, 0.065);
  // Half the amplitude squared a sample.
  EXPECT_NEAR(peaks[0].drop, 900 * 0.045, 15.0);
  EXPECT_GT(peaks[0].drop, 3.0 * peaks[1].drop);
}

TEST(FindLines, SeesALineInColouredNoiseBesideTheNoisesOwnSwell) {
  std::vector<double> angle;
  std::vector<double> residual;
  const std::vector<double> white = WhiteNoise(2000, 1.0, 5);
  double state = 0.0;
  for (std::size_t i = 0; i < 2000; ++i) {
    angle.push_back(kTwoPi * static_cast<double>(i) / 1000.0);
    state = 0.95 * state + white[i];
    residual.push_back(state + 0.25 * std::cos(300.0 * angle.back()));
  }
  const auto peaks = FindLines(angle, residual, std::vector<double>(2000, 1.0), 0.5, 450.0, 1);
  ASSERT_EQ(peaks.size(), 1u);
  EXPECT_NEAR(peaks[0].order, 300.0, 0.3);
}

// Two channels over one even time, of a length that no fast transform has, with a part that is not known.
TEST(FindLines, TakesEvenSamplesForTheirOwnBins) {
  constexpr double kStep = 0.01;
  constexpr std::size_t kCount = 3001;
  std::vector<double> time;
  std::vector<double> residual;
  std::vector<double> weights;
  const std::vector<double> noise = WhiteNoise(2 * kCount, 0.5, 6);
  for (std::size_t i = 0; i < 2 * kCount; ++i) {
    const std::size_t sample = i % kCount;
    time.push_back(7.0 + kStep * static_cast<double>(sample));
    residual.push_back(0.8 + 0.2 * std::cos(296.4 * time.back() + 0.5) + 0.1 * std::cos(53.2 * time.back()) +
                       noise[i]);
    weights.push_back(sample > 700 && sample < 1000 ? 0.0 : 1.0);
  }
  const auto peaks = FindLines(time, residual, weights, 0.5, kPi / kStep, 2, kStep);
  ASSERT_EQ(peaks.size(), 2u);
  // Three standard deviations of an order, and of the drop of half the amplitude squared a sample.
  const double known = 2.0 * (kCount - 299);
  EXPECT_NEAR(peaks[0].order, 296.4, 3.0 * std::sqrt(24.0 / known) * 0.5 / 0.2 / 30.0);
  EXPECT_NEAR(peaks[1].order, 53.2, 3.0 * std::sqrt(24.0 / known) * 0.5 / 0.1 / 30.0);
  EXPECT_NEAR(peaks[0].drop, known * 0.02, 3.0 * 2.0 * 0.5 * std::sqrt(known * 0.02));
}

TEST(LogSearchLocationsOfLine, SpreadsWhatChanceMayFindEvenlyOverOctaves) {
  constexpr double kLowest = 0.5;
  constexpr double kHighest = 128.0;
  // Shares of the error that small ranges of orders get, which are one over their search locations.
  const auto share = [&](double from, double to) {
    constexpr int kParts = 20000;
    const double step = (to - from) / kParts;
    double sum = 0.0;
    for (int i = 0; i < kParts; ++i)
      sum += step / std::exp(LogSearchLocationsOfLine(from + (i + 0.5) * step, kLowest, kHighest));
    return sum / (kHighest - kLowest);
  };
  EXPECT_NEAR(share(kLowest, kHighest), 1.0, 1e-4);
  EXPECT_NEAR(share(0.5, 1.0), 1.0 / 8.0, 1e-4);
  EXPECT_NEAR(share(64.0, 128.0), 1.0 / 8.0, 1e-4);
  // A fit may leave the range that was searched.
  EXPECT_EQ(LogSearchLocationsOfLine(0.1, kLowest, kHighest),
            LogSearchLocationsOfLine(kLowest, kLowest, kHighest));
  EXPECT_EQ(LogSearchLocationsOfLine(140.0, kLowest, kHighest),
            LogSearchLocationsOfLine(kHighest, kLowest, kHighest));
}

TEST(LogSearchLocationsOfWidth, AWideWindowHasFewLocationsAndTheNarrowestPayForTheOctaves) {
  // Five octaves from 1 to 32: the narrowest have half of these times their own, and 32 times fewer are as
  // wide.
  EXPECT_NEAR(LogSearchLocationsOfWidth(1.0, 1.0, 32.0), std::log(2.5), 1e-12);
  EXPECT_NEAR(LogSearchLocationsOfWidth(32.0, 1.0, 32.0), std::log(2.5 / 32.0), 1e-12);
  // A fit may leave the range that was searched.
  EXPECT_EQ(LogSearchLocationsOfWidth(1e-6, 1.0, 32.0), LogSearchLocationsOfWidth(0.5, 1.0, 32.0));
  EXPECT_EQ(LogSearchLocationsOfWidth(1e6, 1.0, 32.0), LogSearchLocationsOfWidth(32.0, 1.0, 32.0));
}

TEST(FindWindows, FindsWhereTheMeanIsRaised) {
  std::vector<double> abscissa;
  std::vector<double> residual = WhiteNoise(500, 0.2, 6);
  for (std::size_t i = 0; i < 500; ++i) {
    abscissa.push_back(static_cast<double>(i));
    if (i >= 210 && i < 240) residual[i] += 0.4;
  }
  const auto windows = FindWindows(abscissa, residual, std::vector<double>(500, 1.0), 5.0, 100.0, 1);
  ASSERT_EQ(windows.size(), 1u);
  EXPECT_NEAR(windows[0].centre, 225.0, 5.0);
  EXPECT_NEAR(windows[0].width, 30.0, 10.0);
}

// Each would go on for ever.
TEST(FindWindows, HasNoneWhereTheirStepsAreLostInRounding) {
  constexpr double kDenormal = 5e-324;
  const std::vector<double> residual = WhiteNoise(500, 0.2, 6);
  const std::vector<double> weights(500, 1.0);
  std::vector<double> tiny(500, 0.0);
  std::vector<double> far(500, 1e11);
  for (std::size_t i = 0; i < 500; i += 2) {
    tiny[i] = kDenormal;
    far[i] += 1e-4;
  }
  EXPECT_TRUE(FindWindows(tiny, residual, weights, kDenormal, kDenormal, 2).empty());
  EXPECT_TRUE(FindWindows(far, residual, weights, 1e-6, 2.5e-5, 2).empty());
  EXPECT_FALSE(WindowsMove(far, 1e-6));
  EXPECT_TRUE(WindowsMove(far, 1e-3));
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_scans_test
