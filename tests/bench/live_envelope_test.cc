// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/live_envelope.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::live_envelope_test {
namespace {

using WhenFull = Envelope::WhenFull;

constexpr std::size_t kTorque = 0;
constexpr std::size_t kTemperature = 2;
constexpr std::uint64_t kCampaign = 0xabc;

LiveExtremes TorqueOf(double value_Nm) {
  LiveExtremes extremes;
  extremes.channels[kTorque].Add(value_Nm);
  return extremes;
}

Extremes OfAll(const Envelope& envelope, std::size_t channel) {
  Extremes all;
  for (const LiveExtremes& bin : envelope.bins()) all.Merge(bin.channels[channel]);
  return all;
}

TEST(LiveExtremes, LeaveOutBadChannelsAndWhatIsNoNumber) {
  LiveExtremes extremes;
  Readings readings;
  readings.output_torque_Nm = -3.0;
  readings.gear_temperature_degC = 41.0;
  extremes.Add(readings);
  readings.output_torque_Nm = std::numeric_limits<double>::quiet_NaN();
  readings.gear_temperature_degC = 999.0;
  readings.bad_channels = 1u << static_cast<unsigned>(Channel::kGearTemperature);
  extremes.Add(readings);
  EXPECT_EQ(extremes.channels[kTorque], (Extremes{-3.0, -3.0, -3.0}));
  EXPECT_EQ(extremes.channels[kTemperature], (Extremes{41.0, 41.0, 41.0}));
  LiveExtremes none;
  EXPECT_TRUE(none.empty());
  none.Merge(extremes);
  EXPECT_EQ(none.channels, extremes.channels);
}

// A heartbeat's worth of nothing, as after the last reading of a phase, does not take it back to the first
// second.
TEST(LiveExtremes, AreAsOldAsTheirNewestReading) {
  Readings readings;
  readings.time = std::chrono::seconds(5);
  LiveExtremes extremes;
  extremes.Add(readings);
  extremes.Merge({});
  EXPECT_EQ(extremes.newest, std::chrono::seconds(5));
  readings.time = std::chrono::seconds(6);
  LiveExtremes later;
  later.Add(readings);
  extremes.Merge(later);
  EXPECT_EQ(extremes.newest, std::chrono::seconds(6));
}

// A reading every 10 ms for more than a day, one of which is not like the others.
TEST(Envelope, HasASpikeOfOneReadingAmongTenMillionWithItsRightValue) {
  constexpr int kReadings = 10'000'000;
  constexpr int kSpike = 6'543'210;
  constexpr double kSpike_Nm = 57.3125;
  constexpr double kPeriod_s = 0.01;
  Envelope envelope(160, 4.0, WhenFull::kMergePairs);
  LiveExtremes second;
  for (int i = 0; i < kReadings; ++i) {
    second.channels[kTorque].Add(i == kSpike ? kSpike_Nm : 40.0 + 1e-3 * (i % 7));
    if (i % 100 != 99) continue;
    envelope.Add(kPeriod_s * i, second);
    second = {};
  }
  EXPECT_LE(envelope.bins().size(), 160U);
  EXPECT_GT(envelope.bins().size(), 80U);
  EXPECT_EQ(envelope.width_s(), 1024.0);  // 4 s, doubled until 160 of them hold 100 000 s
  int with_spike = 0;
  for (std::size_t i = 0; i < envelope.bins().size(); ++i) {
    const Extremes& torque = envelope.bins()[i].channels[kTorque];
    EXPECT_EQ(torque.min, 40.0);
    const double begins_s = envelope.start_s() + static_cast<double>(i) * envelope.width_s();
    const bool has_spike =
        kPeriod_s * kSpike >= begins_s && kPeriod_s * kSpike < begins_s + envelope.width_s();
    EXPECT_EQ(torque.max, has_spike ? kSpike_Nm : 40.0 + 1e-3 * 6) << i;
    with_spike += has_spike ? 1 : 0;
  }
  EXPECT_EQ(with_spike, 1);
}

TEST(Envelope, ForgetsTheOldestAndKeepsTheRest) {
  Envelope envelope(4, 2.0, WhenFull::kForgetOldest);
  for (int second = 0; second < 11; ++second) envelope.Add(second, TorqueOf(second));
  EXPECT_EQ(envelope.start_s(), 4.0);
  EXPECT_EQ(envelope.width_s(), 2.0);
  ASSERT_EQ(envelope.bins().size(), 4U);
  EXPECT_EQ(envelope.bins()[0].channels[kTorque], (Extremes{4.0, 5.0, 5.0}));
  EXPECT_EQ(envelope.bins()[3].channels[kTorque], (Extremes{10.0, 10.0, 10.0}));
  // After a gap that is longer than all bins only the newest has a value.
  envelope.Add(1e6 + 1.0, TorqueOf(7.0));
  ASSERT_EQ(envelope.bins().size(), 4U);
  EXPECT_EQ(envelope.start_s() + 3.0 * envelope.width_s(), 1e6);
  EXPECT_TRUE(envelope.bins()[2].empty());
  EXPECT_EQ(envelope.bins()[3].channels[kTorque].last, 7.0);
}

TEST(Envelope, KeepsWhatComesEarlierThanItBegins) {
  Envelope envelope(4, 2.0, WhenFull::kMergePairs);
  envelope.Add(10.0, TorqueOf(1.0));
  envelope.Add(3.0, TorqueOf(-5.0));
  EXPECT_EQ(OfAll(envelope, kTorque).min, -5.0);
  envelope.Add(std::numeric_limits<double>::quiet_NaN(), TorqueOf(99.0));
  EXPECT_EQ(OfAll(envelope, kTorque).max, 1.0);
}

TEST(Envelope, RefusesWhatIsNone) {
  const auto message = [](std::size_t bins, double width_s) -> std::string {
    try {
      Envelope(bins, width_s, WhenFull::kMergePairs);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(1, 1.0), "most_bins = 1 is too few (expected at least 2)");
  EXPECT_EQ(message(2, 0.0), "width_s = 0 is not a positive number");
}

TEST(LiveEnvelopeFile, OutlivesItsRunAndIsGoneOnWith) {
  const daq::ScratchFolder scratch;
  const auto path = scratch.path() / "envelope";
  {
    LiveEnvelopeFile file(path, kCampaign);
    for (int second = 0; second < 700; ++second) file.Add(second, TorqueOf(second == 3 ? 57.3125 : 40.0));
  }
  {
    LiveEnvelopeFile next(path, kCampaign);
    next.Add(700.0, TorqueOf(-12.5));
  }
  const auto kept = ReadLiveEnvelopes(path, kCampaign);
  ASSERT_TRUE(kept);
  EXPECT_EQ(OfAll(kept->whole, kTorque), (Extremes{-12.5, 57.3125, -12.5}));
  EXPECT_EQ(kept->whole.width_s(), 8.0);
  // The last 160 bins of 4 s do not reach back to the third second.
  EXPECT_EQ(OfAll(kept->recent, kTorque).max, 40.0);
  EXPECT_TRUE(kept->whole.bins()[5].channels[kTemperature].empty());
}

TEST(LiveEnvelopeFile, BeginsAnewWhereTheFileIsDamagedOrAnotherCampaigns) {
  const daq::ScratchFolder scratch;
  const auto path = scratch.path() / "envelope";
  EXPECT_FALSE(ReadLiveEnvelopes(path, kCampaign));
  std::ofstream(path) << "half a file";
  EXPECT_FALSE(ReadLiveEnvelopes(path, kCampaign));
  { LiveEnvelopeFile(path, kCampaign).Add(1.0, TorqueOf(5.0)); }
  EXPECT_TRUE(ReadLiveEnvelopes(path, kCampaign));
  EXPECT_FALSE(ReadLiveEnvelopes(path, kCampaign + 1));
  { LiveEnvelopeFile(path, kCampaign + 1).Add(1.0, TorqueOf(6.0)); }
  const auto other = ReadLiveEnvelopes(path, kCampaign + 1);
  ASSERT_TRUE(other);
  EXPECT_EQ(OfAll(other->whole, kTorque).min, 6.0);
  // Where it cannot be made nobody sees anything, and nothing ends.
  LiveEnvelopeFile nowhere("/nowhere/envelope", kCampaign);
  nowhere.Add(1.0, TorqueOf(5.0));
}

}  // namespace
}  // namespace strainwave::bench::live_envelope_test
