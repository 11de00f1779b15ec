// SPDX-License-Identifier: Apache-2.0
#include "bench/page/live_channels.h"

#include <gtest/gtest.h>

#include "analysis/units.h"

namespace strainwave::bench::page_live_test {
namespace {

TEST(LiveChannels, HaveSmallestLargestAndLastOfEachBinInTheUnitsOfASchedule) {
  LiveEnvelopes envelopes;
  for (const double torque_Nm : {40.0, 57.3125, -1.0}) {
    LiveExtremes values;
    values.channels[0].Add(torque_Nm);
    values.channels[1].Add(RadPerSFromRpm(2400.0));
    envelopes.recent.Add(8.0, values);
    envelopes.whole.Add(8.0, values);
  }
  envelopes.recent.Add(17.0, {});
  envelopes.taken = {1000, 5000, 7};
  const auto answer = LiveChannelsJson(envelopes, {0, 6500, 7});
  EXPECT_EQ(answer["age_s"], 1.5);
  EXPECT_EQ(answer["quantities"][1], nlohmann::json({{"quantity", "input speed"}, {"unit", "rpm"}}));
  const auto& recent = answer["recent"];
  EXPECT_EQ(recent["bin_s"], 4.0);
  EXPECT_EQ(recent["bench_time_s"], nlohmann::json({8.0, 12.0, 16.0}));
  EXPECT_EQ(recent["output torque"]["min"], nlohmann::json({-1.0, nullptr, nullptr}));
  EXPECT_EQ(recent["output torque"]["max"], nlohmann::json({57.3125, nullptr, nullptr}));
  EXPECT_EQ(recent["output torque"]["last"][0], -1.0);
  EXPECT_NEAR(recent["input speed"]["max"][0].get<double>(), 2400.0, 1e-3);
  EXPECT_TRUE(recent["gear temperature"]["last"][0].is_null());
  EXPECT_EQ(answer["whole"]["output torque"]["max"], nlohmann::json({57.3125}));
}

TEST(LiveChannels, AreNullWhereNothingWasKept) {
  const auto answer = LiveChannelsJson(std::nullopt, {});
  EXPECT_TRUE(answer["age_s"].is_null() && answer["recent"].is_null() && answer["whole"].is_null());
  EXPECT_EQ(answer["quantities"].size(), 4U);
}

}  // namespace
}  // namespace strainwave::bench::page_live_test
