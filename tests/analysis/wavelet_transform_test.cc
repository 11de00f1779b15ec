// SPDX-License-Identifier: Apache-2.0
#include "analysis/wavelets/transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <new>
#include <random>
#include <string>
#include <vector>

#include "analysis/wavelets/decomposition.h"
#include "analysis/wavelets/packets.h"
#include "tests/analysis/golden.h"
#include "tests/analysis/message_of.h"
#include "tests/analysis/white_noise.h"

namespace {
int allocations = 0;
}  // namespace

// Every allocation of this program is counted. Inlined, they would look like a malloc that delete ends.
__attribute__((noinline)) void* operator new(std::size_t size) {
  ++allocations;
  if (void* place = std::malloc(size)) return place;
  throw std::bad_alloc();
}
__attribute__((noinline)) void operator delete(void* place) noexcept { std::free(place); }
__attribute__((noinline)) void operator delete(void* place, std::size_t) noexcept { std::free(place); }

namespace strainwave::analysis::wavelets::wavelet_transform_test {
namespace {

constexpr Border kBorders[] = {Border::kSymmetric, Border::kPeriodization, Border::kZero};
// Sums of up to 40 products of numbers of size one.
constexpr double kRounding = 1e-13;

// The signal written out to both sides, sample by sample, with as many copies as it takes.
std::vector<double> WrittenOut(std::vector<double> x, std::size_t margin, Border border) {
  if (border == Border::kPeriodization && x.size() % 2 == 1) x.push_back(x.back());
  std::vector<double> mirrored(x.rbegin(), x.rend());
  std::vector<double> long_signal;
  const std::size_t copies = margin / x.size() + 1;
  for (std::size_t copy = 0; copy <= 2 * copies; ++copy) {
    // The middle copy is the signal itself; mirrored copies alternate away from it.
    const bool odd = (copy + copies) % 2 == 1;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double value = border == Border::kSymmetric && odd ? mirrored[i] : x[i];
      long_signal.push_back(border == Border::kZero && copy != copies ? 0.0 : value);
    }
  }
  const auto begin = static_cast<std::ptrdiff_t>(copies * x.size() - margin);
  return {long_signal.begin() + begin, long_signal.end() - begin};
}

// Full convolution of the written-out signal, then every second value.
std::vector<double> ByDefinition(const std::vector<double>& x, const std::vector<double>& h, Border border) {
  const std::size_t margin = 2 * h.size();
  const std::vector<double> extended = WrittenOut(x, margin, border);
  const std::size_t count = CoefficientCount(x.size(), h.size(), border);
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t place = 2 * i + margin + (border == Border::kPeriodization ? h.size() / 2 : 1);
    long double sum = 0.0L;
    for (std::size_t j = 0; j < h.size(); ++j) sum += static_cast<long double>(h[j]) * extended.at(place - j);
    out.push_back(static_cast<double>(sum));
  }
  return out;
}

void ExpectClose(const std::vector<double>& got, const std::vector<double>& expected, double tolerance,
                 const std::string& what) {
  ASSERT_EQ(got.size(), expected.size()) << what;
  for (std::size_t i = 0; i < got.size(); ++i) {
    ASSERT_NEAR(got[i], expected[i], tolerance) << what << " at " << i;
  }
}

TEST(Transform, IsTheConvolutionOfItsDefinitionForEveryWaveletBorderAndLength) {
  for (const std::string& name : WaveletNames()) {
    const FilterBank bank = FilterBankOf(name);
    for (const Border border : kBorders) {
      for (const std::size_t n : {1U, 2U, 3U, 7U, 16U, 39U, 41U, 255U, 1030U}) {
        const std::vector<double> x = WhiteNoise(n, 1.0, static_cast<unsigned>(n));
        std::vector<double> a(CoefficientCount(n, bank.length(), border));
        std::vector<double> d(a.size());
        Transform(x, bank, border, a, d);
        const std::string what = name + " " + std::string(NameOf(border)) + " " + std::to_string(n);
        ExpectClose(a, ByDefinition(x, bank.decomposition_low, border), kRounding, what);
        ExpectClose(d, ByDefinition(x, bank.decomposition_high, border), kRounding, what);
        std::vector<double> alone(a.size());
        Transform(x, bank, border, alone, {});
        EXPECT_EQ(alone, a) << what;
        Transform(x, bank, border, {}, alone);
        EXPECT_EQ(alone, d) << what;
      }
    }
  }
}

TEST(Decompose, IsUndoneByReconstructAtEveryLengthAndDepth) {
  for (const std::string& name : WaveletNames()) {
    const FilterBank bank = FilterBankOf(name);
    // As good as the digits of the filters.
    const double tolerance = name.starts_with("sym") ? 1e-9 : 1e-12;
    for (const Border border : kBorders) {
      for (const std::size_t n : {1U, 2U, 5U, 40U, 77U, 600U}) {
        const std::vector<double> x = WhiteNoise(n, 1.0, 7);
        Decomposition decomposition;
        Decompose(x, bank, border, 4, Details::kKeep, decomposition);
        ExpectClose(Reconstruct(decomposition, bank, border, n), x, tolerance,
                    name + " " + std::string(NameOf(border)) + " " + std::to_string(n));
      }
    }
  }
}

TEST(Decompose, OfAnotherSignalOfTheSameLengthAllocatesNothing) {
  const FilterBank bank = FilterBankOf("sym8");
  const std::vector<double> first = WhiteNoise(1000, 1.0, 1);
  const std::vector<double> second = WhiteNoise(1000, 1.0, 2);
  Decomposition decomposition;
  Decompose(first, bank, Border::kSymmetric, 7, Details::kLeaveOut, decomposition);
  const int before = allocations;
  Decompose(second, bank, Border::kSymmetric, 7, Details::kLeaveOut, decomposition);
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(decomposition.details[0].empty());
}

// A polynomial of degree below the number of vanishing moments leaves no detail where the border has no part
// in it.
TEST(Transform, LeavesNoDetailOfAPolynomial) {
  const FilterBank bank = FilterBankOf("db4");
  std::vector<double> x(64);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::pow(static_cast<double>(i) / 64.0, 3) - 0.3;
  std::vector<double> d(CoefficientCount(x.size(), bank.length(), Border::kZero));
  Transform(x, bank, Border::kZero, {}, d);
  ASSERT_GT(d.size(), bank.length());
  for (std::size_t i = bank.length() / 2; i + bank.length() / 2 < d.size(); ++i)
    EXPECT_NEAR(d[i], 0.0, kRounding);
}

TEST(DecomposePackets, SplitsEveryNodeAsTheTransformDoes) {
  const FilterBank bank = FilterBankOf("db6");
  const std::vector<double> x = WhiteNoise(333, 1.0, 5);
  Packets packets;
  for (int repeat = 0; repeat < 2; ++repeat) DecomposePackets(x, bank, Border::kSymmetric, 3, packets);
  const std::vector<std::string> paths = PacketPaths(3);
  ASSERT_EQ(packets.leaves.size(), 8U);
  for (std::size_t leaf = 0; leaf < 8; ++leaf) {
    std::vector<double> node = x;
    for (const char letter : paths[leaf]) {
      node = ByDefinition(node, letter == 'a' ? bank.decomposition_low : bank.decomposition_high,
                          Border::kSymmetric);
    }
    ExpectClose(packets.leaves[leaf], node, kRounding, paths[leaf]);
  }
  ExpectClose(ReconstructPackets(packets.leaves, bank, Border::kSymmetric, x.size()), x, 1e-12, "back");
}

// A tone of rising frequency must move through the leaves in the order that is claimed.
TEST(FrequencyOrder, FollowsATone) {
  const FilterBank bank = FilterBankOf("db20");
  const std::vector<std::size_t> order = FrequencyOrder(3);
  for (std::size_t band = 0; band < 8; ++band) {
    std::vector<double> tone(1024);
    const double cycles_per_sample = (static_cast<double>(band) + 0.5) / 16.0;
    for (std::size_t i = 0; i < tone.size(); ++i) {
      tone[i] = std::sin(2.0 * 3.14159265358979 * cycles_per_sample * static_cast<double>(i));
    }
    Packets packets;
    DecomposePackets(tone, bank, Border::kPeriodization, 3, packets);
    double energy = 0.0;
    for (const double value : packets.leaves[order[band]]) energy += value * value;
    EXPECT_GT(energy, 0.8 * 512.0) << band;
  }
}

TEST(Transform, EqualsPyWaveletsOnTheGoldenFiles) {
  if (!testing_data::GoldenFolder()) GTEST_SKIP() << testing_data::kNoGolden;
  for (const char* wavelet : {"sym8", "sym4", "db6"}) {
    for (const Border border : {Border::kSymmetric, Border::kPeriodization}) {
      for (const char* n : {"1000", "1023", "4096"}) {
        const std::string name = std::string(wavelet) + "_" + std::string(NameOf(border)) + "_" + n;
        const std::vector<double> x =
            testing_data::GoldenColumns("signal_" + std::string(n) + ".csv").at("x");
        const auto columns = testing_data::GoldenColumns("dwt_" + name + ".csv");
        Decomposition decomposition;
        Decompose(x, FilterBankOf(wavelet), border, 7, Details::kKeep, decomposition);
        for (std::size_t level = 1; level <= 7; ++level) {
          const std::string number = std::to_string(level);
          ExpectClose(decomposition.approximations[level - 1], columns.at("cA" + number), 1e-12,
                      name + number);
          ExpectClose(decomposition.details[level - 1], columns.at("cD" + number), 1e-12, name + number);
        }
      }
    }
  }
}

TEST(DecomposePackets, EqualsPyWaveletsOnTheGoldenFiles) {
  if (!testing_data::GoldenFolder()) GTEST_SKIP() << testing_data::kNoGolden;
  const std::vector<std::string> paths = PacketPaths(3);
  for (const Border border : {Border::kSymmetric, Border::kPeriodization}) {
    for (const std::string n : {"1000", "1023", "4096"}) {
      const std::vector<double> x = testing_data::GoldenColumns("signal_" + n + ".csv").at("x");
      const auto columns =
          testing_data::GoldenColumns("wpd_db6_" + std::string(NameOf(border)) + "_" + n + ".csv");
      Packets packets;
      DecomposePackets(x, FilterBankOf("db6"), border, 3, packets);
      for (std::size_t leaf = 0; leaf < 8; ++leaf) {
        ExpectClose(packets.leaves[leaf], columns.at(paths[leaf]), 1e-12, n + paths[leaf]);
      }
    }
  }
}

TEST(Transform, SaysWhatIsWrongWithItsArguments) {
  const FilterBank bank = FilterBankOf("db2");
  std::vector<double> x(8);
  std::vector<double> places(4);
  Decomposition decomposition;
  Packets packets;
  EXPECT_EQ(MessageOf([&] { Transform({}, bank, Border::kZero, places, {}); }),
            "signal has 0 samples (expected at least 1)");
  EXPECT_EQ(MessageOf([&] { Transform(x, bank, Border::kSymmetric, places, {}); }),
            "approximation has 4 places (expected 5)");
  EXPECT_EQ(MessageOf([&] { InverseTransform(places, x, bank, Border::kZero, x); }),
            "detail has 8 places (expected 4)");
  EXPECT_EQ(MessageOf([&] { InverseTransform(places, places, bank, Border::kZero, x); }),
            "signal has 8 places (expected 6)");
  EXPECT_EQ(MessageOf([&] { InverseTransform({}, {}, bank, Border::kPeriodization, {}); }),
            "approximation has 0 coefficients (expected at least 1 for db2)");
  EXPECT_EQ(MessageOf([&] { Decompose(x, bank, Border::kZero, 0, Details::kKeep, decomposition); }),
            "levels = 0 is not in 1 to 30");
  EXPECT_EQ(MessageOf([&] { DecomposePackets(x, bank, Border::kZero, 17, packets); }),
            "levels = 17 is not in 1 to 16");
  EXPECT_EQ(MessageOf([&] {
              ReconstructPackets({places, places, places}, bank, Border::kZero, 8);
            }),
            "leaves has 3 series (expected a power of two)");
  EXPECT_EQ(MessageOf([] { BorderOf("reflect"); }),
            "mode = 'reflect' is not known (expected symmetric, periodization or zero)");
}

}  // namespace
}  // namespace strainwave::analysis::wavelets::wavelet_transform_test
