// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/settings.h"

#include <gtest/gtest.h>

namespace strainwave::bench {
namespace {

std::string ErrorsOf(const std::string& text) {
  try {
    ParseMonitorSettings(text, "m.yaml");
  } catch (const MonitorSettingsError& error) {
    return error.what();
  }
  return "none";
}

TEST(MonitorSettings, TheExampleNamesEveryKey) {
  const MonitorSettings settings =
      ReadMonitorSettings(std::filesystem::path(STRAINWAVE_SOURCE_DIR) / "bench/monitor/monitor.yaml");
  EXPECT_EQ(settings.stale_after_ms, 300'000);
  ASSERT_EQ(settings.limits.size(), 2U);
  EXPECT_EQ(settings.limits[0].first, "k2_Nm_per_rad");
  EXPECT_EQ(settings.limits[0].second.alarm_below, 21'000.0);
  EXPECT_EQ(settings.limits[0].second.hold_ms, 30'000);
  EXPECT_EQ(settings.limits[1].second.hysteresis, 0.05);
  EXPECT_EQ(settings.mqtt->node, "bench-1");
  EXPECT_EQ(settings.mqtt->keep.windows, 10'000U);
  EXPECT_EQ(settings.mqtt->keep.bytes, std::size_t{64} << 20);
  EXPECT_EQ(settings.prometheus->port, 9464);
  EXPECT_EQ(settings.modbus->port, 1502);
}

TEST(MonitorSettings, PublishNowhereUnlessASectionSaysSo) {
  const MonitorSettings settings = ParseMonitorSettings("monitor: 1\n", "m.yaml");
  EXPECT_FALSE(settings.mqtt);
  EXPECT_FALSE(settings.prometheus);
  EXPECT_FALSE(settings.modbus);
  EXPECT_EQ(settings.windows.by, WindowRule::By::kTrigger);
}

TEST(MonitorSettings, TellAllMistakesWithTheirPlace) {
  EXPECT_EQ(ErrorsOf("monitor: 1\n"
                     "stale_after: 5\n"
                     "windows:\n"
                     "  by: time\n"
                     "mqtt:\n"
                     "  port: 99999\n"
                     "  nod: b\n"),
            "m.yaml:2:14: error: stale_after = 5: no unit (expected us, ms, s, min, h or d)\n"
            "m.yaml:4:7: error: by = time: not known (expected trigger or revolution)\n"
            "m.yaml:6:9: error: port = 99999: out of range (expected a whole number from 1 to 65535)\n"
            "m.yaml:7:3: error: unknown key 'nod', did you mean 'node'? (expected host, port, group, node, "
            "primary_host, user, password, keep_windows, keep_mebibytes)");
}

TEST(MonitorSettings, RefuseLimitsThatContradictEachOther) {
  EXPECT_EQ(ErrorsOf("monitor: 1\nthresholds:\n  - output: a\n    warning_above: 5\n    alarm_above: 4\n"),
            "m.yaml:5:18: error: alarm_above = 4 is below warning_above = 5 (expected the alarm beyond the "
            "warning)");
  EXPECT_EQ(ErrorsOf("monitor: 1\nthresholds:\n  - output: a\n    warning_below: 5\n    alarm_below: 6\n"),
            "m.yaml:5:18: error: alarm_below = 6 is above warning_below = 5 (expected the alarm beyond the "
            "warning)");
  EXPECT_EQ(
      ErrorsOf("monitor: 1\nthresholds:\n  - output: a\n"),
      "m.yaml:3:13: error: the threshold has no limit (expected warning_above, warning_below, alarm_above "
      "or alarm_below)");
  EXPECT_EQ(
      ErrorsOf("monitor: 1\nthresholds:\n  - output: a\n    warning_below: 1\n    warning_above: 2\n"
               "    hysteresis: 0.6\n"),
      "m.yaml:6:17: error: nothing is left between 1 and 2 (expected lower and upper limits further apart "
      "than twice the hysteresis)");
  EXPECT_EQ(
      ErrorsOf(
          "monitor: 1\nthresholds:\n  - {output: a, warning_above: 1}\n  - {output: a, alarm_above: 1}\n"),
      "m.yaml:4:14: error: output a has a threshold already (expected one for each output)");
}

TEST(MonitorSettings, ATriggerChannelNeedsItsLevel) {
  EXPECT_EQ(ErrorsOf("monitor: 1\nwindows:\n  trigger_channel: trigger_V\n"),
            "m.yaml:2:1: error: missing key 'trigger_level' (expected a number)");
  EXPECT_EQ(ErrorsOf("monitor: 1\nwindows:\n  by: revolution\n  trigger_channel: t\n  trigger_level: 1\n"),
            "m.yaml:4:20: error: trigger_channel has no meaning for windows by revolution (expected 'by: "
            "trigger')");
}

}  // namespace
}  // namespace strainwave::bench
