// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/gap_ledger.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/daq/acquisition/sample_blocks.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::gap_ledger_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr double kRate_hz = 51200;

SampleBlock Counted(std::uint64_t number, std::uint32_t samples, unsigned bits = 64, nanoseconds late = {}) {
  SampleBlock block = BlockAt(SourceOf(1, kRate_hz), number, samples, SampleNumber);
  if (bits < 64) block.header.device_counter &= (std::uint64_t{1} << bits) - 1;
  block.header.arrival += late;
  return block;
}

class GapLedgerWidths : public testing::TestWithParam<unsigned> {};

// A device that sends blocks of changing length, of which a tenth get lost on the way, some in long runs, and
// some come twice; each late by up to 20 ms.
TEST_P(GapLedgerWidths, ReportsExactlyTheLossesThatWereInjected) {
  std::mt19937_64 random(GetParam());
  GapLedger ledger({.bits = GetParam()}, kRate_hz);
  std::uint64_t number = 12345;  // the device ran before
  std::uint64_t injected = 0, injected_gaps = 0, repeated = 0, reported = 0, received = 0;
  std::uint64_t lost_in_a_row = 0;
  const std::uint64_t begin = number;
  for (int i = 0; i < 60000; ++i) {
    const auto samples = static_cast<std::uint32_t>(1 + random() % 2048);
    const bool is_lost = random() % 10 == 0;
    const std::uint64_t run = is_lost ? samples + (random() % 50 == 0 ? random() % 200000 : 0) : 0;
    if (is_lost && i > 0) {
      lost_in_a_row += run;
      number += run;
      continue;
    }
    SampleBlock block = Counted(number, samples, GetParam(), nanoseconds(random() % 20'000'000));
    const std::optional<Gap> gap = ledger.Admit(block);
    ASSERT_EQ(gap.has_value(), lost_in_a_row > 0) << i;
    if (gap) {
      ASSERT_EQ(gap->lost, lost_in_a_row) << i;
      ASSERT_EQ(gap->first_lost, number - lost_in_a_row - begin) << i;
      ASSERT_TRUE(gap->is_exact);
      reported += gap->lost;
      injected += lost_in_a_row;
      ++injected_gaps;
    }
    ASSERT_EQ(block.header.lost_before, lost_in_a_row);
    ASSERT_EQ((block.header.flags & kAfterGap) != 0, lost_in_a_row > 0);
    ASSERT_EQ(block.header.first_sample, number - begin) << i;
    ASSERT_EQ(block.header.samples, samples);
    lost_in_a_row = 0;
    received += samples;
    number += samples;
    if (random() % 20 == 0) {
      SampleBlock again = Counted(number - samples, samples, GetParam(), milliseconds(20));
      ASSERT_FALSE(ledger.Admit(again));
      ASSERT_EQ(again.header.samples, 0U);
      repeated += samples;
    }
  }
  EXPECT_GT(injected_gaps, 4000U);
  EXPECT_EQ(reported, injected);
  EXPECT_EQ(ledger.totals(),
            (GapTotals{.received = received, .lost = injected, .repeated = repeated, .gaps = injected_gaps}));
}

INSTANTIATE_TEST_SUITE_P(OfCounters, GapLedgerWidths, testing::Values(16U, 24U, 32U, 64U));

TEST(GapLedger, CountsWholeTurnsOfANarrowCounterByTheTimeThatWentBy) {
  GapLedger ledger({.bits = 16}, kRate_hz);
  SampleBlock first = Counted(0, 512, 16);
  ledger.Admit(first);
  // Exactly three turns: the counter goes on as if nothing had happened.
  SampleBlock after = Counted(512 + 3 * 65536, 512, 16, milliseconds(400));
  ASSERT_EQ(after.header.device_counter, 512U);
  EXPECT_EQ(ledger.Admit(after)->lost, 3U * 65536U);
}

TEST(GapLedger, TakesABlockThatWasHeldUpForWhatItIs) {
  GapLedger ledger({}, kRate_hz);
  SampleBlock first = Counted(0, 512);
  ledger.Admit(first);
  SampleBlock held_up = Counted(512, 512, 64, std::chrono::seconds(60));
  EXPECT_FALSE(ledger.Admit(held_up));
  SampleBlock at_once = Counted(1024 + 7, 512, 64, std::chrono::seconds(59));
  EXPECT_EQ(ledger.Admit(at_once)->lost, 7U);
  EXPECT_EQ(ledger.totals().resets, 0U);
}

TEST(GapLedger, TellsACounterThatStartedAnewFromARepeat) {
  for (const unsigned bits : {32U, 64U}) {
    GapLedger ledger({.bits = bits}, kRate_hz);
    SampleBlock first = Counted(1'000'000, 512, bits);
    ledger.Admit(first);
    // Half a second later it counts from 0.
    SampleBlock anew = Counted(1'000'512 + 25600, 512, bits);
    anew.header.device_counter = 0;
    const std::optional<Gap> gap = ledger.Admit(anew);
    ASSERT_TRUE(gap);
    EXPECT_TRUE(gap->is_reset);
    EXPECT_FALSE(gap->is_exact);
    EXPECT_NEAR(static_cast<double>(gap->lost), 25600, 1);
    EXPECT_EQ(anew.header.flags, kAfterGap | kAfterReset | kLostIsEstimate);
    EXPECT_EQ(anew.header.first_sample, 512 + gap->lost);
    EXPECT_EQ(ledger.totals().estimated, gap->lost);
    SampleBlock next = Counted(1'000'512 + 25600 + 512, 512, bits);
    next.header.device_counter = 512;
    EXPECT_FALSE(ledger.Admit(next));
  }
}

TEST(GapLedger, TakesRepeatsThatDoNotEndForACounterThatStartedAnew) {
  GapLedger ledger({}, kRate_hz);
  std::uint64_t number = 0;
  for (; number < 20480; number += 512) {
    SampleBlock block = Counted(number, 512);
    ledger.Admit(block);
  }
  // It starts anew so soon that 0.4 s of samples could have come twice.
  std::uint64_t passed_on = 0;
  for (std::uint64_t anew = 0; anew < 102400; anew += 512) {
    SampleBlock block = Counted(number + anew, 512);
    block.header.device_counter = anew;
    ledger.Admit(block);
    passed_on += block.header.samples;
  }
  // 20 480 were taken for repeats; then the counter goes on where it had been, and nothing else is lost.
  EXPECT_EQ(ledger.totals().repeated, 20480U);
  EXPECT_EQ(passed_on, 102400U - 20480U);
}

TEST(GapLedger, TakesADeviceThatSendsOneBlockForEverForOneThatStartedAnew) {
  GapLedger ledger({}, kRate_hz);
  int resets = 0;
  for (int i = 0; i < 150; ++i) {
    SampleBlock same = Counted(0, 512, 64, milliseconds(10 * i));
    if (const std::optional<Gap> gap = ledger.Admit(same)) resets += gap->is_reset;
  }
  // After a second of repeats, 101 blocks of 10 ms.
  EXPECT_EQ(resets, 1);
  EXPECT_EQ(ledger.totals().received, 2U * 512);
}

TEST(GapLedger, BelievesALongLossThatTookItsTime) {
  GapLedger ledger({}, kRate_hz);
  SampleBlock first = Counted(0, 512);
  ledger.Admit(first);
  SampleBlock after = Counted(512 + 60 * 51200, 512, 64, milliseconds(300));
  const std::optional<Gap> gap = ledger.Admit(after);
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->lost, 60U * 51200);
  EXPECT_TRUE(gap->is_exact);
  EXPECT_FALSE(gap->is_reset);
}

TEST(GapLedger, TakesAStepThatIsLongerThanTheTimeForAJump) {
  GapLedger ledger({}, kRate_hz);
  SampleBlock first = Counted(0, 512);
  ledger.Admit(first);
  SampleBlock jumped = Counted(512, 512);
  jumped.header.device_counter = 5'000'000'000;
  const std::optional<Gap> gap = ledger.Admit(jumped);
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->lost, 0U);
  EXPECT_TRUE(gap->is_reset);
}

TEST(GapLedger, TakesTheRepeatedPartOffABlock) {
  GapLedger ledger({.bits = 16}, kRate_hz);
  SampleBlock first = Counted(65000, 512, 16);
  ledger.Admit(first);
  SampleBlock overlaps = Counted(65412, 512, 16);
  EXPECT_FALSE(ledger.Admit(overlaps));
  EXPECT_EQ(overlaps.header.samples, 412U);
  EXPECT_EQ(overlaps.Value(0, 0), SampleNumber(65512, 0));
  EXPECT_EQ(overlaps.header.flags, kHadRepeats);
  EXPECT_EQ(ledger.totals().repeated, 100U);
  SampleBlock next = Counted(65924, 512, 16);
  EXPECT_FALSE(ledger.Admit(next));
  EXPECT_EQ(next.header.first_sample, 924U);
}

TEST(GapLedger, RefusesACounterThatNoneHas) {
  EXPECT_EQ(MessageOf<std::invalid_argument>([] { GapLedger({.bits = 7}, 1.0); }),
            "bits = 7 is not between 8 and 64");
  EXPECT_EQ(MessageOf<std::invalid_argument>([] { GapLedger({}, 0.0); }), "rate_hz = 0 is not above zero");
}

}  // namespace
}  // namespace strainwave::daq::acquisition::gap_ledger_test
