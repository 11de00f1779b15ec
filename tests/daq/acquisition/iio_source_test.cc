// SPDX-License-Identifier: Apache-2.0
// libiio itself, over its network context, against a device behind an emulated iiod.

#include "daq/acquisition/sources/iio_source.h"

#include <gtest/gtest.h>

#include <system_error>

#include "daq/acquisition/gap_ledger.h"
#include "tests/daq/acquisition/emulated_iiod.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::iio_source_test {
namespace {

constexpr std::chrono::nanoseconds kPatience = std::chrono::seconds(5);

TEST(IioSource, ReadsCountsWithTheDriversScale) {
  const EmulatedIiod device({"--blocks", "20"});
  IioSource source({.uri = device.uri(), .device = "adxl355", .samples_a_block = 50, .source = 3});
  source.Start();
  ASSERT_EQ(source.description().channels.size(), 2U);
  EXPECT_EQ(source.description().rate_hz, 1000);
  EXPECT_EQ(source.description().channels[0].name, "accel_x");
  EXPECT_EQ(source.description().channels[0].unit, "m/s^2");
  EXPECT_NEAR(source.description().channels[0].calibration.Apply(1000), 0.038245, 1e-12);
  EXPECT_EQ(source.description().channels[0].limits.saturation_low, -524288);
  EXPECT_EQ(source.description().channels[0].limits.saturation_high, 524287);
  EXPECT_FALSE(source.has_time_stamps());
  SampleBlock block(100);
  std::uint64_t samples = 0;
  NextResult result{};
  while ((result = source.Next(block, kPatience)) == NextResult::kBlock) {
    ASSERT_EQ(block.header.device_counter, samples);
    for (std::uint32_t i = 0; i < block.header.samples; ++i) {
      ASSERT_EQ(block.Value(i, 0), static_cast<double>(samples + i));
      ASSERT_EQ(block.Value(i, 1), -static_cast<double>(samples + i));
    }
    samples += block.header.samples;
  }
  EXPECT_EQ(samples, 1000U);
  EXPECT_EQ(result, NextResult::kFailed);
  EXPECT_EQ(source.trouble(), "iio:" + device.uri() + "/adxl355: No such device");
}

// The emulated device lives for 20 blocks a connection, and counts from 0 on the next one.
TEST(IioSource, FindsALostDeviceAgainAndShowsTheGap) {
  for (const bool stamped : {false, true}) {
    const EmulatedIiod device(stamped ? std::vector<std::string>{"--stamp"} : std::vector<std::string>{});
    IioSource source({.uri = device.uri(),
                      .device = "adxl355",
                      .samples_a_block = 50,
                      .between_attempts = std::chrono::milliseconds(1)});
    source.Start();
    GapLedger ledger({}, source.description().rate_hz);
    SampleBlock block(100);
    for (int connection = 0; connection < 3; ++connection) {
      for (int i = 0; i < 20; ++i) {
        NextResult result{};
        while ((result = source.Next(block, kPatience)) == NextResult::kNothingYet) {
        }
        ASSERT_EQ(result, NextResult::kBlock);
        ledger.Admit(block);
        ASSERT_EQ(block.Value(0, 0), 50.0 * i);
        ASSERT_EQ(block.header.lost_before > 0, connection > 0 && i == 0);
      }
      ASSERT_EQ(source.Next(block, kPatience), NextResult::kFailed);
    }
    EXPECT_EQ(ledger.totals().gaps, 2U);
    EXPECT_EQ(ledger.totals().received, 3000U);
  }
}

TEST(IioSource, TellsWhatTheDeviceDroppedByItsTimeStamps) {
  const EmulatedIiod device({"--stamp", "--blocks", "20", "--skip-after", "8", "--skip", "333"});
  IioSource source({.uri = device.uri(), .device = "iio:device0", .samples_a_block = 50});
  source.Start();
  EXPECT_TRUE(source.has_time_stamps());
  EXPECT_EQ(source.description().channels.size(), 2U);
  GapLedger ledger({}, source.description().rate_hz);
  SampleBlock block(100);
  while (source.Next(block, kPatience) == NextResult::kBlock) {
    // It came as fast as it could, not in its own time.
    block.header.arrival = block.header.device_time;
    ledger.Admit(block);
    ASSERT_EQ(block.Value(0, 0), static_cast<double>(block.header.first_sample));
    ASSERT_EQ(block.header.device_time.count(),
              5'000'000'000 + static_cast<std::int64_t>(block.header.first_sample) * 1'000'000);
  }
  EXPECT_EQ(ledger.totals(), (GapTotals{.received = 1000, .lost = 333, .gaps = 1}));
}

TEST(IioSource, SaysWhatIsNotThere) {
  const EmulatedIiod device({});
  const auto message = [&](IioSettings settings) {
    IioSource source(std::move(settings));
    return MessageOf<std::system_error>([&] { source.Start(); });
  };
  EXPECT_EQ(message({.uri = device.uri(), .device = "ad7606"}),
            "the IIO context '" + device.uri() + "' has no device 'ad7606': No such device");
  EXPECT_EQ(message({.uri = device.uri(), .device = "adxl355", .channels = {"accel_z"}}),
            "'iio:" + device.uri() + "/adxl355' has no channel 'accel_z' to scan: No such device");
  EXPECT_TRUE(
      message({.uri = "xml:/none.xml", .device = "x"}).starts_with("no IIO context at 'xml:/none.xml': "));
}

}  // namespace
}  // namespace strainwave::daq::acquisition::iio_source_test
