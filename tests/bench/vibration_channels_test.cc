// SPDX-License-Identifier: Apache-2.0
#include "bench/records/vibration_channels.h"

#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "analysis/quantities.h"
#include "daq/record_rules.h"

namespace strainwave::bench::vibration_channels_test {
namespace {

using Names = std::vector<std::string>;

constexpr int kRows = 600;
constexpr double kRate_hz = 5000.0;

std::vector<double> Values(const std::function<double(int)>& at) {
  std::vector<double> values;
  for (int i = 0; i < kRows; ++i) values.push_back(at(i));
  return values;
}

std::vector<double> Noise(unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Values([&](int) { return normal(random); });
}

daq::Record RecordOf(std::vector<std::pair<std::string, std::vector<double>>> columns) {
  daq::Record record;
  record.kind = daq::RecordKind::kVibration;
  for (auto& [name, values] : columns) record.columns.push_back({name, std::move(values), "", ""});
  return record;
}

// The names of the channels, beside an accelerometer that is one.
Names ChannelsBeside(const std::string& name, const std::vector<double>& values) {
  Names channels = SortVibrationColumns(RecordOf({{"accel_z_m_per_s2", Noise()}, {name, values}})).channels;
  std::erase(channels, "accel_z_m_per_s2");
  return channels;
}

Names WarningsBeside(const std::string& name, const std::vector<double>& values) {
  Names texts;
  for (const auto& [column, text] :
       SortVibrationColumns(RecordOf({{"accel_z_m_per_s2", Noise()}, {name, values}})).warnings) {
    texts.push_back(text);
  }
  return texts;
}

TEST(SortVibrationColumns, TakesNothingThatAPredictorLearns) {
  for (const analysis::Quantity& quantity : analysis::kPredictedQuantities) {
    EXPECT_EQ(ChannelsBeside(std::string(quantity.name), Noise(2)), Names{}) << quantity.name;
    EXPECT_EQ(WarningsBeside(std::string(quantity.name), Noise(2)), Names{}) << quantity.name;
  }
}

// The format's own rules know no table of another module.
TEST(CheckRecord, HoldsWhatAPredictorLearnsToBeANumber) {
  for (const analysis::Quantity& quantity : analysis::kPredictedQuantities) {
    daq::Record record = RecordOf({{"accel_z_m_per_s2", Noise()}});
    record.SetMetadata("sample_rate_hz", "5000");
    EXPECT_TRUE(daq::CheckRecord(record).empty());
    record.SetMetadata(std::string(quantity.name), "stiff");
    ASSERT_EQ(daq::CheckRecord(record).size(), 1U) << quantity.name;
    EXPECT_EQ(daq::CheckRecord(record)[0].what, std::string(quantity.name) + " is 'stiff'");
  }
}

TEST(SortVibrationColumns, TakesNoNameThatStandsForTimeAnIndexOrALabel) {
  for (const char* name :
       {"Time", "time", "Time [s]", "Timestamp_s", "timeStamp", "elapsed_ms", "t_us", "Sample No",
        "sample_index", "rowId", "Unix Time", "label", "Label_1", "target", "fault_class", "run"}) {
    EXPECT_EQ(ChannelsBeside(name, Noise(2)), Names{}) << name;
  }
  EXPECT_EQ(WarningsBeside("rowId", Noise(2)), Names{"the column rowId is left out: the name stands for "
                                                     "time, an index or a label (expected the name and "
                                                     "unit of a signal, such as accel_x_m_per_s2)"});
}

TEST(SortVibrationColumns, TakesNoTorqueSpeedOrTemperatureUnderWhichTheGearRuns) {
  for (const char* name : {"output_torque_Nm", "torque_Nm", "input_speed_rpm", "gear_temperature_degC"}) {
    EXPECT_EQ(ChannelsBeside(name, Noise(2)), Names{}) << name;
    EXPECT_EQ(WarningsBeside(name, Noise(2)), Names{}) << name << " is read elsewhere";
  }
  EXPECT_EQ(ChannelsBeside("motor_torque_Nm", Noise(2)), Names{"motor_torque_Nm"});
}

TEST(SortVibrationColumns, TakesNoRampWhateverItsName) {
  const auto rounded = Values([](int i) { return std::round(1e3 * i / kRate_hz) / 1e3; });
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.4, 0.4);
  const std::vector<std::pair<const char*, std::vector<double>>> ramps{
      {"counts of a logger", Values([](int i) { return 1000.0 + i; })},
      {"falling", Values([](int i) { return -0.25 * i; })},
      {"stamps to the millisecond", rounded},
      {"stamps that jitter", Values([&](int i) { return (i + jitter(random)) / kRate_hz; })},
      {"stamps with a pause", Values([](int i) { return (i < 200 ? i : 900 + i) / kRate_hz; })},
      {"a counter of eight bits", Values([](int i) { return i % 256; })},
      {"seven digits, beyond an hour",
       Values([](int i) { return std::round(1e3 * (4000.0 + i / 100.0)) / 1e3; })}};
  for (const auto& [what, values] : ramps) {
    EXPECT_EQ(ChannelsBeside("aux_V", values), Names{}) << what;
    EXPECT_EQ(WarningsBeside("aux_V", values).size(), 1U) << what;
  }
  EXPECT_EQ(WarningsBeside("aux_V", ramps[0].second),
            Names{"the column aux_V is left out: it goes on by one step a sample, as time or an index does "
                  "(expected a "
                  "signal)"});
}

TEST(SortVibrationColumns, TakesSignalsWhateverTheyLookLike) {
  std::vector<double> walk = Noise(3);
  for (std::size_t i = 1; i < walk.size(); ++i) walk[i] += walk[i - 1];
  const std::vector<std::pair<const char*, std::vector<double>>> signals{
      {"noise", Noise(4)},
      {"a slow sine, half a turn of it", Values([](int i) { return std::sin(3.0 * i / kRows); })},
      {"a triangle", Values([](int i) { return std::abs(i % 100 - 50); })},
      {"a walk", walk},
      {"a warming sensor of few steps", Values([](int i) { return 0.1 * std::floor(4.0 * i / kRows); })},
      {"a dead sensor", Values([](int) { return 0.5; })}};
  for (const auto& [what, values] : signals) {
    EXPECT_EQ(ChannelsBeside("mic_Pa", values), Names{"mic_Pa"}) << what;
    EXPECT_EQ(WarningsBeside("mic_Pa", values), Names{}) << what;
  }
}

TEST(SortVibrationColumns, TakesNamesWithoutAUnitOnlyWhereNoneHasOne) {
  EXPECT_EQ(ChannelsBeside("DE", Noise(6)), Names{});
  EXPECT_EQ(WarningsBeside("DE", Noise(6)),
            Names{"the column DE is left out: no unit stands in its name (expected DE_UNIT)"});
  const auto alone = SortVibrationColumns(
      RecordOf({{"DE", Noise(6)}, {"FE", Noise(7)}, {"bearing", Values([](int) { return 3.0; })}}));
  EXPECT_EQ(alone.channels, (Names{"DE", "FE"}));
  ASSERT_EQ(alone.warnings.size(), 3U);
  EXPECT_EQ(alone.warnings[0].second,
            "the column DE is taken for a signal although no unit stands in its name (expected DE_UNIT)");
  EXPECT_EQ(alone.warnings[2].second,
            "the column bearing is left out: no unit stands in its name (expected bearing_UNIT)");
}

}  // namespace
}  // namespace strainwave::bench::vibration_channels_test
