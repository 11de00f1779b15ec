// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/pause.h"

#include <gtest/gtest.h>

namespace strainwave::bench::pause_test {
namespace {

constexpr std::int64_t kHour_ms = 3'600'000;
constexpr std::int64_t kUtc_ms = 1'772'366'400'000;
constexpr std::uint64_t kBoot = 1;
constexpr std::uint64_t kNextBoot = 2;

TEST(Pause, IsThatOfTheBootsClockHoweverUtcIsSet) {
  const Moment then{kUtc_ms, kHour_ms, kBoot};
  const Pause plain = PauseBetween(then, {kUtc_ms + kHour_ms, 2 * kHour_ms, kBoot});
  EXPECT_EQ(plain.length_s, 3600.0);
  EXPECT_EQ(plain.clock, "clock of this machine since its start");
  const Pause set_back = PauseBetween(then, {kUtc_ms - 4 * kHour_ms, 2 * kHour_ms, kBoot});
  EXPECT_EQ(set_back.length_s, 3600.0);
  EXPECT_EQ(set_back.clock, "clock of this machine since its start; UTC was set by -18000.0 s meanwhile");
  const Pause set_ahead = PauseBetween(then, {kUtc_ms + 9 * kHour_ms, 2 * kHour_ms, kBoot});
  EXPECT_EQ(set_ahead.length_s, 3600.0);
  EXPECT_EQ(set_ahead.clock, "clock of this machine since its start; UTC was set by +28800.0 s meanwhile");
}

TEST(Pause, IsNotKnownWhereTheBootsClockWentBack) {
  const Pause pause = PauseBetween({kUtc_ms, 2 * kHour_ms, kBoot}, {kUtc_ms + kHour_ms, kHour_ms, kBoot});
  EXPECT_EQ(pause.length_s, std::nullopt);
  EXPECT_EQ(pause.clock,
            "the clock of this boot went back by 3600.0 s, as in a machine brought back from a copy");
}

TEST(Pause, AcrossBootsIsThatOfUtc) {
  const Pause pause = PauseBetween({kUtc_ms, 9 * kHour_ms, kBoot}, {kUtc_ms + kHour_ms, 60'000, kNextBoot});
  EXPECT_EQ(pause.length_s, 3600.0);
  EXPECT_EQ(pause.clock, "UTC of this machine");
}

TEST(Pause, IsNotKnownWhereUtcIsImpossible) {
  const Moment then{kUtc_ms, 9 * kHour_ms, kBoot};
  const Pause below_zero = PauseBetween(then, {kUtc_ms - kHour_ms, 60'000, kNextBoot});
  EXPECT_EQ(below_zero.length_s, std::nullopt);
  EXPECT_EQ(below_zero.clock, "UTC of this machine was set back, it says -3600.0 s");
  // Up for two hours since the campaign stood, and UTC says that it stood for one.
  const Pause too_short = PauseBetween(then, {kUtc_ms + kHour_ms, 2 * kHour_ms, kNextBoot});
  EXPECT_EQ(too_short.length_s, std::nullopt);
  EXPECT_EQ(
      too_short.clock,
      "UTC of this machine was set back, it says 3600.0 s, but the machine was started 7200.0 s ago and "
      "the campaign stood before that");
  const Pause years = PauseBetween(then, {kUtc_ms + 20 * 8766 * kHour_ms, 60'000, kNextBoot});
  EXPECT_EQ(years.length_s, std::nullopt);
  EXPECT_EQ(years.clock, "UTC of this machine was set ahead, it says 20 years");
}

TEST(Pause, SinceACheckpointOfAnEarlierVersionIsThatOfUtc) {
  EXPECT_EQ(PauseBetween({kUtc_ms, 0, 0}, {kUtc_ms + 1000, 9 * kHour_ms, kBoot}).length_s, 1.0);
  EXPECT_EQ(PauseBetween({kUtc_ms, 0, 0}, {kUtc_ms - 1000, 9 * kHour_ms, kBoot}).length_s, std::nullopt);
}

TEST(Moment, OfNowIsOfThisBoot) {
  const Moment first = Now();
  const Moment second = Now();
  EXPECT_NE(first.boot, 0U);
  EXPECT_EQ(first.boot, second.boot);
  EXPECT_LE(first.since_boot_ms, second.since_boot_ms);
}

}  // namespace
}  // namespace strainwave::bench::pause_test
