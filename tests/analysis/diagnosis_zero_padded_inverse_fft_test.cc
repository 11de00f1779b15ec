// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <complex>
#include <cstddef>
#include <random>
#include <vector>

#include "analysis/diagnosis/vibration/zero_padded_inverse_fft.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis::diagnosis_zero_padded_inverse_fft_test {
namespace {

// Term by term, as the header has it; one list is longer than the next, and the object is used for other
// sizes.
TEST(ZeroPaddedInverseFft, AreTheSumsOfLinesTurnedToEachPoint) {
  std::mt19937_64 generator(5);
  std::normal_distribution<float> normal;
  ZeroPaddedInverseFft sums;
  for (const std::size_t points : {std::size_t{1}, std::size_t{2}, std::size_t{16}, std::size_t{256}}) {
    const std::size_t most = points == 1 ? 1 : points / 2;
    std::vector<std::vector<std::complex<float>>> lines(ZeroPaddedInverseFft::kLists);
    sums.Clear(points);
    for (std::size_t list = 0; list < ZeroPaddedInverseFft::kLists; ++list) {
      for (std::size_t k = 0; k < most - most * list / 16; ++k) {
        lines[list].emplace_back(normal(generator), normal(generator));
        sums.Set(list, k, lines[list].back());
      }
    }
    sums.Sum();
    for (std::size_t p = 0; p < points; ++p) {
      for (std::size_t list = 0; list < ZeroPaddedInverseFft::kLists; ++list) {
        std::complex<double> expected;
        for (std::size_t k = 0; k < lines[list].size(); ++k) {
          const double turns = static_cast<double>(k * p) / static_cast<double>(points);
          expected += std::complex<double>(lines[list][k]) * std::polar(1.0, kTwoPi * turns);
        }
        const std::size_t at = p * ZeroPaddedInverseFft::kLists + list;
        constexpr double kRoundings = 1e-4;  // of single precision, over a hundred numbers of one
        EXPECT_NEAR(static_cast<double>(sums.real()[at]), expected.real(), kRoundings) << points << ' ' << p;
        EXPECT_NEAR(static_cast<double>(sums.imaginary()[at]), expected.imag(), kRoundings)
            << points << ' ' << p;
      }
    }
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_zero_padded_inverse_fft_test
