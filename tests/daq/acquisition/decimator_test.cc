// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/decimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "daq/acquisition/gap_ledger.h"
#include "tests/daq/acquisition/sample_blocks.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::decimator_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRate_hz = 10000;

struct Output {
  std::vector<std::uint64_t> numbers;
  std::vector<double> values;
  std::vector<BlockHeader> headers;
};
void Collect(const SampleBlock& out, Output& output) {
  if (out.header.samples > 0) output.headers.push_back(out.header);
  for (std::uint32_t i = 0; i < out.header.samples; ++i) {
    output.numbers.push_back(out.header.first_sample + i);
    output.values.push_back(out.Value(i, 0));
  }
}

// The amplitude of a sine of this frequency (of the old rate) behind the filter, over whole blocks of output.
double GainAt(double frequency, const DecimatorSettings& settings) {
  const SourceDescription source = SourceOf(1, 1);
  SampleBlock out(Decimator(source, settings).description().most_samples_a_block);
  // In quadrature, so that each output has its own amplitude.
  double most = 0;
  std::vector<double> parts[2];
  for (int part = 0; part < 2; ++part) {
    Decimator one(source, settings);
    for (std::uint64_t n = 0; n < 40 * one.delay_samples() + 4000; n += 1000) {
      one.Decimate(BlockAt(source, n, 1000,
                           [&](std::uint64_t k, std::size_t) {
                             return std::cos(2 * kPi * std::fmod(frequency * static_cast<double>(k), 1.0) -
                                             part * kPi / 2);
                           }),
                   out);
      for (std::uint32_t i = 0; i < out.header.samples; ++i) parts[part].push_back(out.Value(i, 0));
    }
  }
  for (std::size_t i = 0; i < parts[0].size(); ++i)
    most = std::max(most, std::hypot(parts[0][i], parts[1][i]));
  return most;
}

TEST(Decimator, PassesAndStopsAsStatedInASweepOfSines) {
  for (const unsigned factor : {2U, 3U, 10U, 16U}) {
    for (const double attenuation_db : {60.0, 90.0}) {
      const DecimatorSettings settings{.factor = factor, .pass_band = 0.8, .attenuation_db = attenuation_db};
      const double allowed = std::pow(10, -attenuation_db / 20);
      const double nyquist = 0.5 / factor;
      for (int i = 0; i <= 8; ++i) {  // 2e-7: outputs are floats
        EXPECT_NEAR(GainAt(nyquist * 0.8 * i / 8, settings), 1, allowed + 2e-7) << factor << " pass " << i;
        const double stop = nyquist * 1.2 + (0.5 - nyquist * 1.2) * i / 8;
        EXPECT_LT(GainAt(stop, settings), allowed + 2e-7) << factor << " stop " << i;
      }
    }
  }
}

double Tone(std::uint64_t n) { return std::sin(2 * kPi * 37 * static_cast<double>(n) / kRate_hz); }

TEST(Decimator, TakesItsDelayOffTheTimeStamps) {
  const SourceDescription source = SourceOf(2, kRate_hz);
  Decimator decimator(source, {.factor = 8});
  SampleBlock out(2 * decimator.description().most_samples_a_block);
  Output output;
  std::mt19937 random(1);
  for (std::uint64_t n = 5003; n < 40000;) {
    const auto samples = static_cast<std::uint32_t>(1 + random() % 700);
    SampleBlock block = BlockAt(source, n, samples, [](std::uint64_t k, std::size_t) { return Tone(k); });
    block.header.device_time += std::chrono::seconds(7);
    decimator.Decimate(block, out);
    Collect(out, output);
    n += samples;
  }
  ASSERT_GT(output.values.size(), 4000U);
  // The first whole output, and then each without one missing.
  EXPECT_EQ(output.numbers.front(), (5003 + decimator.delay_samples() + 7) / 8);
  for (std::size_t i = 0; i < output.values.size(); ++i) {
    ASSERT_EQ(output.numbers[i], output.numbers[0] + i);
    ASSERT_NEAR(output.values[i], Tone(8 * output.numbers[i]), 2e-4) << i;
  }
  for (const BlockHeader& header : output.headers) {
    ASSERT_NEAR(static_cast<double>(header.device_time.count()),
                7e9 + static_cast<double>(header.first_sample) * 8e5, 2);
    ASSERT_EQ(header.rate_hz, 1250);
    ASSERT_EQ(header.flags, 0U);
  }
}

TEST(Decimator, DoesNotReachOverAGapAndKeepsItsGrid) {
  const SourceDescription source = SourceOf(1, kRate_hz);
  Decimator decimator(source, {.factor = 8});
  GapLedger ledger({}, kRate_hz);
  SampleBlock out(decimator.description().most_samples_a_block);
  Output output;
  const auto take = [&](std::uint64_t n, std::uint32_t samples, bool is_true) {
    // What lies in the gap is huge: a filter that reached over it, or closed it, would show.
    SampleBlock block =
        BlockAt(source, n, samples, [&](std::uint64_t k, std::size_t) { return is_true ? Tone(k) : 1e6; });
    ledger.Admit(block);
    decimator.Decimate(block, out);
    Collect(out, output);
  };
  take(0, 3000, true);
  take(3000 + 1234, 3000, true);
  take(7234, 100, true);
  const std::uint64_t reach = decimator.delay_samples();
  std::vector<std::uint64_t> expected;
  for (std::uint64_t m = 0; m < 1000; ++m) {
    const std::uint64_t centre = 8 * m;
    const bool before = centre >= reach && centre + reach < 3000;
    const bool after = centre >= 4234 + reach && centre + reach < 7334;
    if (before || after) expected.push_back(m);
  }
  EXPECT_EQ(output.numbers, expected);
  for (std::size_t i = 0; i < output.values.size(); ++i) {
    ASSERT_NEAR(output.values[i], Tone(8 * output.numbers[i]), 2e-4);
  }
  ASSERT_EQ(output.headers.size(), 3U);
  EXPECT_EQ(output.headers[1].flags, kAfterGap);
  std::uint64_t skipped = 0;
  for (std::size_t i = 1; i < expected.size(); ++i) skipped += expected[i] - expected[i - 1] - 1;
  EXPECT_EQ(output.headers[1].lost_before, skipped);
  EXPECT_EQ(output.headers[2].lost_before, 0U);
}

TEST(Decimator, PassesEverythingAtFactorOne) {
  const SourceDescription source = SourceOf(2, 1000, SampleType::kInt32);
  Decimator decimator(source, {});
  SampleBlock out(200);
  decimator.Decimate(BlockAt(source, 42, 100, SampleNumber), out);
  EXPECT_EQ(out.header.samples, 100U);
  EXPECT_EQ(out.header.first_sample, 42U);
  EXPECT_EQ(out.Value(99, 0), 141);
}

TEST(Decimator, RefusesWhatNoFilterIs) {
  EXPECT_EQ(MessageOf<std::invalid_argument>([] { DecimationTaps({.factor = 0}); }),
            "factor = 0 is not above zero");
  EXPECT_EQ(MessageOf<std::invalid_argument>([] { DecimationTaps({.factor = 2, .pass_band = 1}); }),
            "pass_band = 1 is not between 0 and 1");
  EXPECT_EQ(MessageOf<std::invalid_argument>([] { DecimationTaps({.factor = 2, .attenuation_db = 10}); }),
            "attenuation_db = 10 is not between 21 and 140");
}

}  // namespace
}  // namespace strainwave::daq::acquisition::decimator_test
