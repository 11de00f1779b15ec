// SPDX-License-Identifier: Apache-2.0
// The parts of the monitor that know neither network nor clock.
#include <algorithm>
#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "bench/monitor/alarm.h"
#include "bench/monitor/modbus_registers.h"
#include "bench/monitor/prometheus_text.h"
#include "bench/monitor/sparkplug_metrics.h"

namespace strainwave::bench::monitor_logic_test {
namespace {

using protocols::SparkplugMetric;
using protocols::SparkplugQuality;

constexpr AlarmLimits kLimits{.warning_above = 10.0,
                              .warning_below = std::nullopt,
                              .alarm_above = 20.0,
                              .alarm_below = std::nullopt,
                              .hysteresis = 2.0,
                              .hold_ms = 1000};

// Levels after values at 0, 400, 800, … ms as letters.
std::string LevelsAfter(const AlarmLimits& limits, const std::vector<double>& values) {
  AlarmState state;
  std::string levels;
  std::int64_t now_ms = 0;
  for (const double value : values) {
    state = Next(state, limits, value, now_ms);
    levels += "owa"[static_cast<int>(state.level())];
    now_ms += 400;
  }
  return levels;
}

TEST(Alarm, RisesAfterTheHoldTimeAndNotBefore) {
  EXPECT_EQ(LevelsAfter(kLimits, {11, 11, 11, 11}), "ooow");
  EXPECT_EQ(LevelsAfter(kLimits, {11, 11, 9, 11, 11, 11}), "oooooo")
      << "an excursion that is over counts anew";
}

TEST(Alarm, AValueAtItsLimitIsWithinIt) { EXPECT_EQ(LevelsAfter(kLimits, {10, 10, 10, 10, 10}), "ooooo"); }

TEST(Alarm, FallsOnlyBeyondTheHysteresisAndAfterTheHoldTime) {
  EXPECT_EQ(LevelsAfter(kLimits, {11, 11, 11, 11, 9, 9, 9, 9, 9, 7.9, 7.9, 7.9, 7.9}), "ooowwwwwwwwwo");
}

TEST(Alarm, ValuesThatJumpBetweenWarningAndAlarmStillWarn) {
  EXPECT_EQ(LevelsAfter(kLimits, {11, 21, 11, 21, 11, 21}), "ooowww");
  EXPECT_EQ(LevelsAfter(kLimits, {21, 21, 21, 21}), "oooa");
}

TEST(Alarm, AnAlarmFallsToAWarning) {
  EXPECT_EQ(LevelsAfter(kLimits, {21, 21, 21, 21, 15, 15, 15, 15}), "oooaaaaw");
}

TEST(Alarm, WithoutAHoldTimeEveryValueCounts) {
  AlarmLimits limits = kLimits;
  limits.hold_ms = 0;
  EXPECT_EQ(LevelsAfter(limits, {11, 21, 15, 5}),
            "waw"
            "o");
}

TEST(Alarm, WatchesTheLowerSideToo) {
  const AlarmLimits low{.warning_above = std::nullopt,
                        .warning_below = -5.0,
                        .alarm_above = std::nullopt,
                        .alarm_below = -8.0,
                        .hysteresis = 1.0,
                        .hold_ms = 0};
  EXPECT_EQ(LevelsAfter(low, {-4, -6, -9, -7.5, -6.9, -4.5, -3.9}), "owaawwo");
}

TEST(Alarm, AClockThatIsSetBackMakesNoTimePass) {
  AlarmState state = Next({}, kLimits, 11.0, 5000);
  state = Next(state, kLimits, 11.0, 100);
  EXPECT_EQ(Next(state, kLimits, 11.0, 1099).level(), AlarmLevel::kOk);
  EXPECT_EQ(Next(state, kLimits, 11.0, 1100).level(), AlarmLevel::kWarning);
}

const MonitorFrame kFrame{{"k2_Nm_per_rad", "e_max_arcmin"}, 0.9, 60'000, false};
const MonitorFrame kClasses{{"sound", "worn"}, 0.0, 60'000, true};

MonitorState Good() {
  MonitorState state;
  state.last = MonitorResult{.number = 70'000,
                             .begin_ms = 1'000'000,
                             .end_ms = 1'002'000,
                             .origin = "here",
                             .fault = std::nullopt,
                             .distance = 0.5,
                             .outputs = {{2.5, 2.0, 3.0}, {1.0, 0.5, 1.5}},
                             .alarms = {AlarmLevel::kWarning, AlarmLevel::kOk},
                             .alarm = AlarmLevel::kWarning};
  state.good_windows = 3;
  return state;
}

MonitorState Clipped() {
  MonitorState state = Good();
  state.last->fault = SignalFault{SignalFaultKind::kClipped, "accel_x stays at its end\nand more"};
  state.last->outputs.clear();
  return state;
}

MonitorState Outside() {
  MonitorState state = Good();
  state.last->outside_training = true;
  state.last->distance = 3.0;
  return state;
}

TEST(StatusOf, IsThatOfTheNewestWindowUntilItIsTooOld) {
  EXPECT_EQ(StatusOf({}, kFrame, 0), ValueStatus::kNone);
  EXPECT_EQ(StatusOf(Good(), kFrame, 1'062'000), ValueStatus::kGood);
  EXPECT_EQ(StatusOf(Good(), kFrame, 1'062'001), ValueStatus::kStale);
  EXPECT_EQ(StatusOf(Clipped(), kFrame, 1'062'000), ValueStatus::kBad);
  EXPECT_EQ(StatusOf(Clipped(), kFrame, 1'062'001), ValueStatus::kStale);
  EXPECT_EQ(StatusOf(Outside(), kFrame, 1'003'000), ValueStatus::kOutsideTraining);
}

float FloatAt(const std::vector<std::uint16_t>& registers, std::size_t at) {
  return std::bit_cast<float>((std::uint32_t{registers[at]} << 16) | registers[at + 1]);
}

TEST(ModbusRegisters, HoldTheTableOfTheDocument) {
  const auto registers = ModbusRegisters(Good(), kFrame, 1'005'500);
  ASSERT_EQ(registers.size(), 36U);
  EXPECT_EQ(registers[0], 1);
  EXPECT_EQ(registers[1], 1);
  EXPECT_EQ(registers[2], 1);
  EXPECT_EQ(registers[3], 0);
  EXPECT_EQ((registers[4] << 16) | registers[5], 70'000);
  EXPECT_EQ((registers[6] << 16) | registers[7], 1002);
  EXPECT_EQ(FloatAt(registers, 8), 0.5F);
  EXPECT_EQ(registers[10], 3);
  EXPECT_EQ(registers[11], 2);
  EXPECT_EQ(registers[13], 1005);
  EXPECT_EQ(FloatAt(registers, 20), 2.5F);
  EXPECT_EQ(FloatAt(registers, 22), 2.0F);
  EXPECT_EQ(FloatAt(registers, 24), 3.0F);
  EXPECT_EQ(registers[26], 1);
  EXPECT_EQ(registers[27], 1);
  EXPECT_EQ(FloatAt(registers, 28), 1.0F);
  EXPECT_EQ(registers[34], 0);
}

TEST(ModbusRegisters, HaveACounterThatRunsWhateverTheWindowsDo) {
  for (const MonitorState& state : {MonitorState{}, Good(), Clipped()}) {
    for (const std::int64_t second : {65'534, 65'535, 65'536, 131'072}) {
      EXPECT_EQ(ModbusRegisters(state, kFrame, second * 1000 + 999)[13], second % 65'536);
    }
  }
}

// Of two classes with the probabilities 0.25 and 0.75.
MonitorState Worn() {
  MonitorState state = Good();
  state.last->outputs = {{0.25, 0.25, 0.25}, {0.75, 0.75, 0.75}};
  state.last->alarms = {AlarmLevel::kOk, AlarmLevel::kOk};
  return state;
}

TEST(Classes, ArePublishedByNameWithTheirProbabilities) {
  EXPECT_EQ(ModbusRegisters(Worn(), kClasses, 1'003'000)[12], 2);
  EXPECT_EQ(FloatAt(ModbusRegisters(Worn(), kClasses, 1'003'000), 28), 0.75F);
  EXPECT_EQ(ModbusRegisters(Clipped(), kClasses, 1'003'000)[12], 0);
  EXPECT_EQ(ModbusRegisters(Good(), kFrame, 1'003'000)[12], 0);

  const std::string text = PrometheusText(Worn(), kClasses, 1'003'000);
  for (const char* line : {"strainwave_class{output=\"sound\"} 0\n", "strainwave_class{output=\"worn\"} 1\n",
                           "strainwave_class_probability{output=\"worn\"} 0.75\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << "in\n" << text;
  }
  EXPECT_EQ(text.find("strainwave_predicted"), std::string::npos);
  EXPECT_EQ(text.find("strainwave_alarm"), std::string::npos);
  EXPECT_EQ(PrometheusText(Clipped(), kClasses, 1'003'000).find("strainwave_class"), std::string::npos);

  const auto find = [](const std::vector<SparkplugMetric>& metrics, const std::string& name) {
    return *std::ranges::find(metrics, name, &SparkplugMetric::name);
  };
  const auto good = SparkplugMetrics(Worn(), kClasses, 1'003'000);
  EXPECT_EQ(std::get<std::string>(find(good, "Class").value), "worn");
  EXPECT_EQ(std::get<double>(find(good, "sound/Probability").value), 0.25);
  const auto bad = SparkplugMetrics(Clipped(), kClasses, 1'003'000);
  EXPECT_TRUE(find(bad, "Class").is_null);
  EXPECT_EQ(find(bad, "Class").quality, SparkplugQuality::kBad);
  EXPECT_EQ(bad.size(), good.size()) << "a birth has every metric that data can have";
}

TEST(ModbusRegisters, HaveNoNumberWhereNoneIsGood) {
  const auto status_of = [](const MonitorState& state, std::int64_t now_ms) {
    const auto registers = ModbusRegisters(state, kFrame, now_ms);
    for (const std::size_t at : {20U, 22U, 24U, 28U, 30U, 32U})
      EXPECT_TRUE(std::isnan(FloatAt(registers, at)));
    EXPECT_EQ(registers[27], registers[1]);
    EXPECT_EQ(registers[35], registers[1]);
    return registers[1];
  };
  EXPECT_EQ(status_of({}, 0), 0);
  EXPECT_EQ(status_of(Clipped(), 1'003'000), 2);
  EXPECT_EQ(ModbusRegisters(Clipped(), kFrame, 1'003'000)[3], 6);
  EXPECT_EQ(status_of(Good(), 2'000'000'000'000), 3);
  EXPECT_EQ(ModbusRegisters(Good(), kFrame, 2'000'000'000'000)[10], 65535);
  EXPECT_EQ(status_of(Outside(), 1'003'000), 4);
}

bool Has(const std::string& text, const std::string& line) {
  return ("\n" + text).find("\n" + line) != std::string::npos;
}

TEST(PrometheusText, ShowsValuesWhileTheyAreGood) {
  const std::string text = PrometheusText(Good(), kFrame, 1'003'000);
  EXPECT_TRUE(Has(text, "strainwave_predicted{output=\"k2_Nm_per_rad\"} 2.5\n"));
  EXPECT_TRUE(Has(text, "strainwave_predicted_low{output=\"e_max_arcmin\"} 0.5\n"));
  EXPECT_TRUE(Has(text, "strainwave_alarm{output=\"k2_Nm_per_rad\"} 1\n"));
  EXPECT_TRUE(Has(text, "strainwave_status{status=\"good\"} 1\n"));
  EXPECT_TRUE(Has(text, "strainwave_stale 0\n"));
  EXPECT_TRUE(Has(text, "strainwave_windows_total{status=\"good\"} 3\n"));
  EXPECT_TRUE(Has(text, "strainwave_window_end_timestamp_seconds 1002\n"));
  EXPECT_FALSE(Has(text, "strainwave_mqtt_connected")) << "there is no broker to be connected to";
}

TEST(PrometheusText, ValuesThatAreNotGoodVanish) {
  for (const auto& [state, now_ms, status] :
       {std::tuple{Clipped(), std::int64_t{1'003'000}, "bad"},
        std::tuple{Outside(), std::int64_t{1'003'000}, "outside_training"},
        std::tuple{Good(), std::int64_t{2'000'000}, "stale"},
        std::tuple{MonitorState{}, std::int64_t{0}, "none"}}) {
    const std::string text = PrometheusText(state, kFrame, now_ms);
    EXPECT_EQ(text.find("strainwave_predicted"), std::string::npos) << status;
    EXPECT_TRUE(Has(text, std::string("strainwave_status{status=\"") + status + "\"} 1\n"));
    EXPECT_EQ(Has(text, "strainwave_stale 1\n"), std::string(status) == "stale");
  }
}

const SparkplugMetric& MetricOf(const std::vector<SparkplugMetric>& metrics, const std::string& name) {
  for (const auto& metric : metrics) {
    if (metric.name == name) return metric;
  }
  throw std::runtime_error("no metric " + name);
}

TEST(SparkplugMetrics, CarryTheTimeOfTheWindow) {
  const auto metrics = SparkplugMetrics(Good(), kFrame, 1'003'000);
  for (const auto& metric : metrics) EXPECT_EQ(metric.time_ms, 1'002'000) << metric.name;
  const auto& value = MetricOf(metrics, "k2_Nm_per_rad/Value");
  EXPECT_EQ(std::get<double>(value.value), 2.5);
  EXPECT_EQ(value.quality, SparkplugQuality::kGood);
  EXPECT_FALSE(value.is_null);
  EXPECT_EQ(std::get<std::string>(MetricOf(metrics, "Alarm").value), "warning");
}

TEST(SparkplugMetrics, AreTheSameNamesWhateverThereIsToTell) {
  const auto names = [](const MonitorState& state, std::int64_t now_ms) {
    std::vector<std::string> all;
    for (const auto& metric : SparkplugMetrics(state, kFrame, now_ms)) all.push_back(metric.name);
    return all;
  };
  const auto good = names(Good(), 1'003'000);
  EXPECT_EQ(good.size(), 14U);
  EXPECT_EQ(names({}, 0), good);
  EXPECT_EQ(names(Clipped(), 1'003'000), good);
  EXPECT_EQ(names(Outside(), 1'003'000), good);
  EXPECT_EQ(names(Good(), 2'000'000), good);
}

TEST(SparkplugMetrics, NoValueIsGoodUnlessItsWindowIs) {
  const auto bad = SparkplugMetrics(Clipped(), kFrame, 1'003'000);
  EXPECT_TRUE(MetricOf(bad, "k2_Nm_per_rad/Value").is_null);
  EXPECT_EQ(MetricOf(bad, "k2_Nm_per_rad/Value").quality, SparkplugQuality::kBad);
  EXPECT_EQ(std::get<std::string>(MetricOf(bad, "Quality").value), "clipped: accel_x stays at its end");
  EXPECT_EQ(std::get<std::int64_t>(MetricOf(bad, "Window").value), 70'000);
  const auto outside = SparkplugMetrics(Outside(), kFrame, 1'003'000);
  EXPECT_FALSE(MetricOf(outside, "e_max_arcmin/High").is_null);
  EXPECT_EQ(MetricOf(outside, "e_max_arcmin/High").quality, SparkplugQuality::kBad);
  EXPECT_TRUE(std::get<bool>(MetricOf(outside, "Outside training").value));
  const auto stale = SparkplugMetrics(Good(), kFrame, 2'000'000);
  EXPECT_TRUE(MetricOf(stale, "e_max_arcmin/Low").is_null);
  EXPECT_EQ(MetricOf(stale, "e_max_arcmin/Low").quality, SparkplugQuality::kStale);
  EXPECT_EQ(MetricOf(stale, "e_max_arcmin/Low").time_ms, 2'000'000);
  EXPECT_TRUE(MetricOf(stale, "Window").is_null);
}

}  // namespace
}  // namespace strainwave::bench::monitor_logic_test
