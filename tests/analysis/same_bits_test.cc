// SPDX-License-Identifier: Apache-2.0
// Wavelets and their features have the same bits on every machine (docs/decisions/0013-same-bits.md).
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/features/wavelet_features.h"
#include "analysis/wavelets/decomposition.h"
#include "tests/analysis/each_machine.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::features::same_bits_test {
namespace {

std::vector<std::uint64_t> BitsOf(const std::vector<double>& values) {
  std::vector<std::uint64_t> bits;
  for (const double value : values) bits.push_back(std::bit_cast<std::uint64_t>(value));
  return bits;
}

// Of each machine, that of the first.
template <typename Compute>
void ExpectSameBits(const std::string& what, const Compute& compute) {
  std::vector<std::uint64_t> first;
  int machines = 0;
  testing_machines::OnEachMachine([&](const char* machine) {
    const auto bits = BitsOf(compute());
    if (machines++ == 0) first = bits;
    EXPECT_EQ(bits, first) << what << " on " << machine;
  });
  EXPECT_GE(machines, 1);
}

constexpr std::size_t kLengths[] = {1, 7, 21, 255, 1023, 5000};

TEST(SameBits, OfDecompositions) {
  for (const std::string wavelet : {"haar", "db6", "sym8", "db20"}) {
    const wavelets::FilterBank bank = wavelets::FilterBankOf(wavelet);
    for (const std::size_t length : kLengths) {
      const std::vector<double> signal = WhiteNoise(length, 1.0, 3);
      ExpectSameBits(wavelet, [&] {
        wavelets::Decomposition all;
        wavelets::Decompose(signal, bank, wavelets::Border::kSymmetric, 3, wavelets::Details::kKeep, all);
        std::vector<double> values =
            wavelets::Reconstruct(all, bank, wavelets::Border::kSymmetric, signal.size());
        for (const auto& level : all.approximations) values.insert(values.end(), level.begin(), level.end());
        for (const auto& level : all.details) values.insert(values.end(), level.begin(), level.end());
        return values;
      });
    }
  }
}

TEST(SameBits, OfFeatures) {
  for (const std::size_t length : kLengths) {
    const std::vector<double> signal = WhiteNoise(length, 1.0, 5);
    ExpectSameBits("features", [&] {
      WaveletFeatures features;
      std::vector<double> values(features.CountPerChannel());
      features.Compute(signal, values);
      return values;
    });
  }
}

}  // namespace
}  // namespace strainwave::analysis::features::same_bits_test
