// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/detail_deviations.h"

#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::analysis::features::detail_deviations_test {
namespace {

std::vector<double> Noise(std::size_t samples) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  std::vector<double> signal(samples);
  for (double& value : signal) value = 3.0 + normal(engine);
  return signal;
}

DetailRecipe RecipeOf(const std::string& wavelet, wavelets::Border border, int levels, bool logarithm) {
  return {.wavelet = wavelet, .border = border, .levels = levels, .logarithm = logarithm};
}

// By Parseval: an orthogonal transform of a periodic signal keeps the sum of squares, and a detail has mean
// 0.
TEST(DetailDeviations, AreTheEnergyOfTheCoefficientsOfAPeriodicSignal) {
  const std::vector<double> signal = Noise(1024);
  for (const char* wavelet : {"haar", "db6", "sym8", "coif2"}) {
    constexpr int kLevels = 5;
    const DetailRecipe recipe = RecipeOf(wavelet, wavelets::Border::kPeriodization, kLevels, false);
    std::vector<double> deviations(kLevels);
    DetailDeviations(recipe).Compute(signal, deviations);
    wavelets::Decomposition parts;
    wavelets::Decompose(signal, wavelets::FilterBankOf(wavelet), recipe.border, kLevels,
                        wavelets::Details::kKeep, parts);
    for (std::size_t level = 0; level < kLevels; ++level) {
      const std::vector<double>& detail = parts.details[level];
      const double energy = std::inner_product(detail.begin(), detail.end(), detail.begin(), 0.0);
      EXPECT_NEAR(deviations[level], std::sqrt(energy / 1023.0), 1e-9) << wavelet << " D" << level + 1;
    }
  }
}

TEST(DetailDeviations, AddUpToTheSignalWithTheLastApproximation) {
  for (const wavelets::Border border : {wavelets::Border::kSymmetric, wavelets::Border::kPeriodization}) {
    for (const std::size_t samples : {256U, 251U}) {
      const std::vector<double> signal = Noise(samples);
      constexpr int kLevels = 3;
      DetailDeviations by_detail(RecipeOf("db4", border, kLevels, true));
      std::vector<double> rest = signal;
      for (int level = 1; level <= kLevels; ++level) {
        const std::vector<double> detail = by_detail.Detail(signal, level);
        ASSERT_EQ(detail.size(), samples);
        for (std::size_t i = 0; i < samples; ++i) rest[i] -= detail[i];
      }
      // What is left is the approximation alone: the same transform, with the details put to zero.
      const wavelets::FilterBank bank = wavelets::FilterBankOf("db4");
      wavelets::Decomposition parts;
      wavelets::Decompose(signal, bank, border, kLevels, wavelets::Details::kKeep, parts);
      for (std::vector<double>& detail : parts.details) std::fill(detail.begin(), detail.end(), 0.0);
      const std::vector<double> smooth = wavelets::Reconstruct(parts, bank, border, samples);
      for (std::size_t i = 0; i < samples; ++i) EXPECT_NEAR(rest[i], smooth[i], 1e-9) << i;
    }
  }
}

TEST(DetailDeviations, PutEachToneIntoItsOctave) {
  constexpr int kLevels = 6;
  DetailDeviations by_detail(RecipeOf("sym8", wavelets::Border::kSymmetric, kLevels, true));
  for (int level = 1; level <= kLevels; ++level) {
    // In the middle, on a logarithmic scale, of 2^-(level + 1) to 2^-level of the rate.
    const double frequency = std::exp2(-level - 0.5);
    std::vector<double> tone(4096);
    for (std::size_t i = 0; i < tone.size(); ++i)
      tone[i] = std::sin(2.0 * 3.14159265358979 * frequency * static_cast<double>(i));
    std::vector<double> deviations(kLevels);
    by_detail.Compute(tone, deviations);
    const auto strongest = std::max_element(deviations.begin(), deviations.end()) - deviations.begin();
    EXPECT_EQ(strongest + 1, level);
    EXPECT_NEAR(std::exp(deviations[static_cast<std::size_t>(level - 1)]), std::sqrt(0.5), 0.05);
  }
}

TEST(DetailDeviations, AGainShiftsAllLogarithmsAlike) {
  std::vector<double> signal = Noise(512);
  DetailDeviations by_detail(RecipeOf("db2", wavelets::Border::kSymmetric, 4, true));
  std::vector<double> before(4);
  by_detail.Compute(signal, before);
  for (double& value : signal) value *= 10.0;
  std::vector<double> after(4);
  by_detail.Compute(signal, after);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(after[k] - before[k], std::log(10.0), 1e-9);
}

TEST(DetailDeviations, AConstantHasNoMinusInfinity) {
  const std::vector<double> constant(256, 2.0);
  std::vector<double> deviations(3);
  DetailDeviations(RecipeOf("haar", wavelets::Border::kSymmetric, 3, true)).Compute(constant, deviations);
  for (const double deviation : deviations) EXPECT_TRUE(std::isfinite(deviation));
}

TEST(DetailDeviations, HaveAsManyLevelsAsPyWaveletsCounts) {
  // pywt.dwt_max_level(samples, filter length)
  EXPECT_EQ(MostDetailLevels(4096, 16), 8);
  EXPECT_EQ(MostDetailLevels(3839, 16), 7);
  EXPECT_EQ(MostDetailLevels(1000, 12), 6);
  EXPECT_EQ(MostDetailLevels(1024, 2), 10);
  EXPECT_EQ(MostDetailLevels(29, 16), 0);
}

TEST(DetailDeviations, NamesSayTheChannelAndTheLevel) {
  const std::vector<std::string> channels{"a_g", "b_g"};
  EXPECT_EQ(DetailDeviations(RecipeOf("haar", wavelets::Border::kZero, 2, true)).Names(channels),
            (std::vector<std::string>{"a_g.d1.log_standard_deviation", "a_g.d2.log_standard_deviation",
                                      "b_g.d1.log_standard_deviation", "b_g.d2.log_standard_deviation"}));
  EXPECT_EQ(DetailDeviations(RecipeOf("haar", wavelets::Border::kZero, 1, false)).Names({channels.data(), 1}),
            (std::vector<std::string>{"a_g.d1.standard_deviation"}));
}

TEST(DetailDeviations, RefuseWhatCannotBe) {
  const auto message = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([] { DetailDeviations{DetailRecipe{.levels = 0}}; }), "levels = 0 is not in 1 to 30");
  EXPECT_EQ(message([] {
              std::vector<double> out(8);
              DetailDeviations().Compute(std::vector<double>{1.0}, out);
            }),
            "signal has 1 samples (expected two or more)");
  EXPECT_EQ(message([] { DetailDeviations().Detail(std::vector<double>(9, 1.0), 9); }),
            "level = 9 is not in 1 to 8");
}

}  // namespace
}  // namespace strainwave::analysis::features::detail_deviations_test
