// SPDX-License-Identifier: Apache-2.0
// Rows that say nothing of the machine: written twice, taken before it was switched on, beyond a sensor's
// range.
#include "bench/records/look_at_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "analysis/units.h"

namespace strainwave::bench::look_at_rows_test {
namespace {

using daq::Record;
using Notes = std::vector<daq::RecordNote>;

constexpr int kFirstLine = 6;

Record New(const std::string& kind) {
  Record record;
  record.kind = daq::RecordKind::Named(kind);
  record.source = {"r.csv", kFirstLine, ""};
  return record;
}

void AddColumn(Record& record, const std::string& name, std::vector<double> values) {
  record.columns.push_back({name, std::move(values), "", ""});
}

Notes Looked(Record& record) {
  LookAtSamples(record);
  return record.notes;
}

double Rounded(double value, double step) { return step * std::round(value / step); }

// A gear of 12000 Nm/rad with a loop 0.9' wide, there and back twice; 25 rows a second.
Record Loop(double range_Nm = 1e9) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  Record record = New("hysteresis");
  std::vector<double> time_s;
  std::vector<double> torque_Nm;
  std::vector<double> angle_deg;
  constexpr double kPeak_Nm = 40.0;
  constexpr double kHalfWidth_rad = RadFromArcmin(0.45);
  double lag_rad = 0.0;
  double before_rad = 0.0;
  for (int i = 0; i < 1400; ++i) {
    const double phase = static_cast<double>(i) / 280.0;  // quarters of a loop: up, back, down, back
    const double to_and_fro = std::asin(std::sin(0.5 * kPi * phase)) / (0.5 * kPi);
    const double twist_rad = kPeak_Nm / 12000.0 * to_and_fro;
    lag_rad = std::clamp(lag_rad + twist_rad - before_rad, -kHalfWidth_rad, kHalfWidth_rad);
    before_rad = twist_rad;
    time_s.push_back(0.04 * i);
    torque_Nm.push_back(std::clamp(Rounded(12000.0 * (twist_rad + lag_rad) + 0.03 * normal(random), 1e-4),
                                   -range_Nm, range_Nm));
    angle_deg.push_back(Rounded(DegFromRad(twist_rad) + 2e-5 * normal(random), 1e-7));
  }
  AddColumn(record, "time_s", time_s);
  AddColumn(record, "torque_Nm", torque_Nm);
  AddColumn(record, "output_angle_deg", angle_deg);
  record.SetMetadata("t1_Nm", 8.0);
  record.SetMetadata("t2_Nm", 24.0);
  record.SetMetadata("t3_Nm", 40.0);
  return record;
}

// Of 1500 rpm, with rest in its first rows.
Record Vibration(std::size_t resting_rows) {
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0.0, 0.3);
  Record record = New("vibration");
  std::vector<double> x;
  for (std::size_t i = 0; i < 9000; ++i) {
    const double angle = kTwoPi * 25.0 * static_cast<double>(i) / 6400.0;
    x.push_back((i < resting_rows ? 0.0 : 0.8 * std::cos(angle) + 0.7 * std::sin(2.0 * angle)) +
                noise(random));
  }
  AddColumn(record, "accel_x_m_per_s2", x);
  record.SetMetadata("sample_rate_hz", 6400.0);
  record.SetMetadata("input_speed_rpm", 1500.0);
  return record;
}

TEST(LookAtRows, SaysNothingOfHealthyRecords) {
  for (Record record : {Loop(), Vibration(0)}) EXPECT_EQ(Looked(record), Notes{}) << record.kind.name();
}

TEST(LookAtRows, CountsEachRowThatWasWrittenTwiceOnce) {
  const Record as_it_was = Loop();
  Record record = as_it_was;
  const auto is_twice = [](std::size_t row) { return row % 37 == 20 || row % 101 == 5; };
  std::size_t twice = 0;
  for (std::size_t row = 0; row < as_it_was.rows(); ++row) twice += is_twice(row) ? 1 : 0;
  for (daq::Column& column : record.columns) {
    auto& values = std::get<std::vector<double>>(column.values);
    for (std::size_t row = values.size(); row-- > 0;) {
      if (is_twice(row)) values.insert(values.begin() + static_cast<std::ptrdiff_t>(row), values[row]);
    }
  }
  ASSERT_EQ(record.rows(), as_it_was.rows() + twice);
  EXPECT_EQ(Looked(record),
            (Notes{{kFirstLine + 6, std::to_string(twice) +
                                        " rows repeat the one before, with its time: each counts once"}}));
  for (std::size_t c = 0; c < record.columns.size(); ++c)
    EXPECT_EQ(record.columns[c].values, as_it_was.columns[c].values) << record.columns[c].name;
}

TEST(LookAtRows, TellsOfATorqueWhoseRangeEndsTooSoon) {
  Record record = Loop(37.5);
  const auto count = [&](double end_Nm) {
    return std::to_string(std::ranges::count(record.Doubles("torque_Nm"), end_Nm));
  };
  const auto text = [&](double end_Nm, const char* end) {
    return "torque_Nm is saturated: " + count(end_Nm) + " samples read " + end +
           " Nm to the last digit, an end of its range; what lies beyond is not in the record";
  };
  EXPECT_EQ(Looked(record), (Notes{{0, text(-37.5, "-37.5")}, {0, text(37.5, "37.5")}}));
}

TEST(LookAtRows, LeavesOutTheRowsBeforeAMachineWasSwitchedOn) {
  Record record = Vibration(3100);
  const Notes notes = Looked(record);
  const std::size_t left_out = 9000 - record.rows();
  EXPECT_GE(left_out, 3100U);
  EXPECT_LE(left_out, 3100U + 4U * 256U);
  EXPECT_EQ(notes, (Notes{{kFirstLine, "rows 1 to " + std::to_string(left_out) +
                                           " are left out: the machine stands in them or some of them, the "
                                           "lines at 1 and 2 per turn of its input speed are not there"}}));
}

TEST(LookAtRows, LeavesOutTheRowsWithoutSpeed) {
  Record record = Vibration(3100);
  std::vector<double> speed_rpm(9000, 1500.0);
  std::fill_n(speed_rpm.begin(), 3100, 0.0);
  std::fill(speed_rpm.begin() + 8200, speed_rpm.end(), 3.0);
  AddColumn(record, "input_speed_rpm", speed_rpm);
  EXPECT_EQ(Looked(record),
            (Notes{{kFirstLine,
                    "rows 1 to 3100 are left out: the machine stands in them or some of them, its input "
                    "speed is next to nothing"},
                   {kFirstLine + 8200,
                    "rows 8201 to 9000 are left out: the machine stands in them or some of them, its input "
                    "speed is next to nothing"}}));
  EXPECT_EQ(record.rows(), 5100U);
}

}  // namespace
}  // namespace strainwave::bench::look_at_rows_test
