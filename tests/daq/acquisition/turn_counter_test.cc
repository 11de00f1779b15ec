// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/turn_counter.h"

#include <gtest/gtest.h>

namespace strainwave::daq::acquisition::turn_counter_test {
namespace {

constexpr std::int64_t kTurn = 1 << 20;
constexpr std::int64_t kStep = kTurn / 7;

std::int32_t Sent(std::int64_t counts) { return static_cast<std::int32_t>(counts); }

TEST(TurnCounter, CountsOnEitherWayWhereThirtyTwoBitsGoOver) {
  for (const std::int64_t step : {kStep, -kStep}) {
    TurnCounter counter;
    std::int64_t counts = 12345;
    for (int i = 0; i < 100000; ++i, counts += step) ASSERT_EQ(counter.Follow(Sent(counts)), counts);
    EXPECT_GT(std::abs(counts), 3 * (std::int64_t{1} << 32));
    for (int i = 0; i < 100000; ++i, counts -= step) ASSERT_EQ(counter.Follow(Sent(counts)), counts);
  }
}

TEST(TurnCounter, TakesTheFirstCountsAsTheyAre) {
  for (const std::int32_t first : {INT32_MIN, -1, 0, INT32_MAX}) {
    EXPECT_EQ(TurnCounter().Follow(first), first);
  }
}

TEST(TurnCounter, GoesOnFromWhatWasCountedBefore) {
  for (const std::int64_t before : {100'000 * kTurn + 7, -100'000 * kTurn - 7}) {
    TurnCounter counter(before);
    EXPECT_EQ(counter.Follow(Sent(before + kStep)), before + kStep);
    EXPECT_EQ(counter.counted(), before + kStep);
  }
}

TEST(TurnCounter, GoesTheShorterWayOverAGap) {
  TurnCounter counter;
  EXPECT_EQ(counter.Follow(Sent(2000 * kTurn)), 2000 * kTurn);
  EXPECT_EQ(counter.Follow(Sent(4000 * kTurn)), 4000 * kTurn);
  EXPECT_EQ(counter.Follow(Sent(2100 * kTurn)), 2100 * kTurn);
}

}  // namespace
}  // namespace strainwave::daq::acquisition::turn_counter_test
