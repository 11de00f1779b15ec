// SPDX-License-Identifier: Apache-2.0
#include "bench/trip_test/trip_sheet.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace strainwave::bench::trip_sheet_test {
namespace {

TripSheet Sheet() {
  TripRow torque;
  torque.cause = StopCause::kOutputTorqueLimit;
  torque.signal = "output torque";
  torque.limit = {60.0, "Nm", "limits.output_torque"};
  torque.action = "torque off, brakes on";
  torque.latches = true;
  torque.noticed_within_s = 0.04;
  torque.safe_within_s = 2.04;
  TripRow key = torque;
  key.cause = StopCause::kQuickStopKey;
  key.signal = "quick-stop key";
  key.limit = {std::nullopt, "", "pressed"};
  key.latches = false;
  return {"a bench",
          "bench.yaml",
          true,
          "quick.yaml",
          "2026-03-01T12:00:00.000Z",
          "strainwave 0.1.0",
          {torque, key},
          {{TripVerdict::kPassed, 0.01, 0.3, "output_torque_limit", "tripped after 10 ms, safe after 300 ms"},
           {TripVerdict::kSkipped, {}, {}, "", "the bench has no pendant"}}};
}

TEST(SheetText, IsATableWithWhatASheetIsFiledBy) {
  EXPECT_EQ(
      SheetText(Sheet()),
      "trip test of the interlocks\n"
      "  bench     a bench, simulated (bench.yaml)\n"
      "  limits    quick.yaml\n"
      "  date      2026-03-01T12:00:00.000Z\n"
      "  software  strainwave 0.1.0\n"
      "\n"
      "verdict  signal          limit                         safe within  alarm    action                 "
      "seen\n"
      "passed   output torque   60 Nm (limits.output_torque)  2040 ms      latches  torque off, brakes on  "
      "tripped after 10 ms, safe after 300 ms\n"
      "skipped  quick-stop key  pressed                       2040 ms      no       torque off, brakes on  "
      "the bench has no pendant\n"
      "\n"
      "2 rows: 1 passed, 0 failed, 1 skipped\n");
}

TEST(SheetJson, HasTheSame) {
  const nlohmann::ordered_json document = SheetJson(Sheet());
  EXPECT_EQ(document["good"], true);
  EXPECT_EQ(document["skipped"], 1);
  const auto& torque = document["rows"][0];
  EXPECT_EQ(torque["code"], "output_torque_limit");
  EXPECT_EQ(torque["limit"]["value"], 60.0);
  EXPECT_EQ(torque["limit"]["unit"], "Nm");
  EXPECT_EQ(torque["safe_after_s"], 0.3);
  EXPECT_EQ(torque["verdict"], "passed");
  EXPECT_TRUE(document["rows"][1]["limit"]["value"].is_null());
  EXPECT_TRUE(document["rows"][1]["stopped_as"].is_null());
}

TEST(IsGood, NeedsARowThatPassedAndNoneThatFailed) {
  TripSheet sheet = Sheet();
  EXPECT_TRUE(IsGood(sheet));
  sheet.results[1].verdict = TripVerdict::kFailed;
  EXPECT_FALSE(IsGood(sheet));
  sheet.results[0].verdict = sheet.results[1].verdict = TripVerdict::kSkipped;
  EXPECT_FALSE(IsGood(sheet)) << "nothing was tested";
}

}  // namespace
}  // namespace strainwave::bench::trip_sheet_test
