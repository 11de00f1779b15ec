// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/live_readings.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/configuration/embedded_bench.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::live_readings_test {
namespace {

Readings SomeReadings() {
  Readings readings;
  readings.output_torque_Nm = -39.5;
  readings.input_speed_rad_per_s = RadPerSFromRpm(2400.0);
  readings.gear_temperature_degC = 41.25;
  readings.vibration_rms_m_per_s2 = 2.5;
  readings.bad_channels = 1u << static_cast<unsigned>(Channel::kGearTemperature);
  return readings;
}

schedules::Limits SomeLimits() { return {60.0, RadPerSFromRpm(3000.0), 75.0, 50.0, 0.01}; }

LiveReadings SomeLive() { return {{}, -39.5, RadPerSFromRpm(2400.0), 41.25, 2.5, 0}; }

TEST(LiveReadingsFile, ShowsThemWhileItLivesAndNoLonger) {
  const daq::ScratchFolder scratch;
  const auto path = scratch.path() / "readings";
  {
    LiveReadingsFile file(path);
    EXPECT_FALSE(ReadLiveReadings(path));
    file.Show(SomeReadings());
    const auto shown = ReadLiveReadings(path);
    ASSERT_TRUE(shown);
    EXPECT_EQ(shown->output_torque_Nm, -39.5);
    EXPECT_EQ(shown->gear_temperature_degC, 41.25);
    EXPECT_EQ(shown->bad_channels, 1u << static_cast<unsigned>(Channel::kGearTemperature));
    EXPECT_LT(PauseBetween(shown->taken, Now()).length_s.value_or(1e9), 60.0);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(LiveReadingsFile, BeginsAnewAfterOneThatAKillHasLeftDamaged) {
  const daq::ScratchFolder scratch;
  const auto path = scratch.path() / "readings";
  std::ofstream(path) << "half a file";
  EXPECT_FALSE(ReadLiveReadings(path));
  LiveReadingsFile file(path);
  file.Show(SomeReadings());
  EXPECT_TRUE(ReadLiveReadings(path));
}

TEST(LiveReadingsFile, EndsNothingWhereItCannotBeMade) {
  LiveReadingsFile file("/nowhere/readings");
  file.Show(SomeReadings());
  EXPECT_FALSE(ReadLiveReadings("/nowhere/readings"));
}

TEST(LiveValues, StandBesideTheLimitsInTheUnitsOfASchedule) {
  const auto values = LiveValues(SomeLive(), 0.5, SomeLimits(), EmbeddedBench());
  ASSERT_EQ(values.size(), 4u);
  EXPECT_EQ(values[0].value, -39.5);
  EXPECT_EQ(values[0].limit, 60.0);
  EXPECT_NEAR(values[1].value.value(), 2400.0, 1e-9);
  EXPECT_NEAR(values[1].limit, 3000.0, 1e-9);
  EXPECT_EQ(values[2].value, 41.25);
  EXPECT_EQ(values[3].value, 2.5);
}

TEST(LiveValues, AreNoneWhenStaleBadOrNotMeasured) {
  for (const std::optional<double>& age_s : {std::optional(kOldestLive_s + 0.1), std::optional<double>{}}) {
    for (const LiveValue& live : LiveValues(SomeLive(), age_s, SomeLimits(), EmbeddedBench())) {
      EXPECT_EQ(live.value, std::nullopt);
      EXPECT_EQ(live.missing, "stale");
    }
  }
  LiveReadings one_bad = SomeLive();
  one_bad.bad_channels = 1u << static_cast<unsigned>(Channel::kGearTemperature);
  const auto values = LiveValues(one_bad, 0.5, SomeLimits(), EmbeddedBench());
  EXPECT_TRUE(values[0].value);
  EXPECT_EQ(values[2].value, std::nullopt);
  EXPECT_EQ(values[2].missing, "the channel is bad");
  BenchDescription no_accelerometers = EmbeddedBench();
  no_accelerometers.accelerometers.clear();
  EXPECT_EQ(LiveValues(SomeLive(), 0.5, SomeLimits(), no_accelerometers)[3].missing,
            "the bench has no accelerometers");
}

}  // namespace
}  // namespace strainwave::bench::live_readings_test
