// SPDX-License-Identifier: Apache-2.0
// The look at the samples of an axis.
#include "bench/records/look_at_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "bench/records/looks.h"
#include "tests/bench/logged_records.h"

namespace strainwave::bench::look_at_axis_test {
namespace {

using namespace logged_records;

TEST(LookAtSamplesOfAnAxis, LeavesOutSingleSamplesThatNoAxisMovesTo) {
  const Record healthy = AxisWithVelocity(100.0, 0.02);
  Record record = healthy;
  Change(record, "position_rad",
         [](double value, std::size_t i) { return i == 300 || i == 640 ? 0.9 * value + 0.2 : value; });
  Change(record, "velocity_rad_per_s", [](double value, std::size_t i) { return i == 305 ? 0.0 : value; });
  LookAtSamples(record);
  EXPECT_EQ(
      record.notes,
      (Notes{{kFirstLine + 300,
              "single samples of position_rad stand off their neighbours, as no axis moves: 2, the first in "
              "row 301; their rows are left out"},
             {kFirstLine + 305,
              "single samples of velocity_rad_per_s stand off their neighbours, as no axis moves: 1, the "
              "first in row 306; their rows are left out"}}));
  EXPECT_EQ(record.rows(), healthy.rows() - 3U);
}

TEST(LookAtSamplesOfAnAxis, LeavesOutAVelocityWhoseRangeEndsTooSoon) {
  for (const double whole : {1e-6, 0.02, 0.3}) {  // resolution; the fastest sample is at about 4.2
    Record record = AxisWithVelocity(100.0, whole);
    EXPECT_EQ(Looked(record), std::vector<std::string>{}) << whole;
    EXPECT_NE(record.FindColumn("velocity_rad_per_s"), nullptr);
  }
  Record record = AxisWithVelocity(3.6, 0.02);
  EXPECT_EQ(Looked(record),
            std::vector<std::string>{
                "velocity_rad_per_s is saturated: 49 samples read -3.6, an end of its range, while "
                "the position goes on by -3.846 a second: it is left out, the position tells the "
                "velocity"});
  EXPECT_EQ(record.FindColumn("velocity_rad_per_s"), nullptr);
}

TEST(LookAtSamplesOfAnAxis, TakesOnlyNewValuesOfAChannelThatIsHeld) {
  Record record = Axis(200.0);
  Hold(record, "position_rad", [](std::size_t i) { return i % 4 == 0; });
  EXPECT_EQ(Looked(record),
            (std::vector<std::string>{
                "position_rad repeats its value until the next one comes, in 1200 of 1600 rows, up to "
                "4 rows long; only new values count"}));
  EXPECT_EQ(record.rows(), 400U);
  const Record at_its_rate = Axis(200.0);
  for (std::size_t i = 0; i < record.rows(); ++i) {
    ASSERT_EQ(record.Doubles("position_rad")[i], at_its_rate.Doubles("position_rad")[4 * i]);
    ASSERT_EQ(record.Doubles("time_s")[i], at_its_rate.Doubles("time_s")[4 * i]);
  }
}

TEST(LookAtSamplesOfAnAxis, LeavesOutASegmentInWhichASensorStoodStill) {
  Record record = Axis(200.0);
  Hold(record, "torque_Nm", [](std::size_t i) { return i < 701 || i > 760; });
  LookAtSamples(record);
  EXPECT_EQ(record.notes,
            (Notes{{kFirstLine + 700,
                    "61 samples of torque_Nm repeat one value, rows 701 to 761, 3.50 to 3.80 s: a "
                    "sensor or logger that stood still; they are left out"}}));
  EXPECT_EQ(record.rows(), 1600U - 61U);
}

// Noise in motion is that of the samples' times. At rest an encoder shows none: its last step stands, or
// comes and goes while friction lets the axis creep.
TEST(LookAtSamplesOfAnAxis, KeepsARestOnAnEncoder) {
  constexpr double kStep_rad = 1e-6;
  std::mt19937 random(3);
  Record record = Axis(200.0);
  double clock_s = 0.0;
  Change(record, "position_rad", [&](double, std::size_t i) {
    const double to_rest = std::clamp((900.0 - static_cast<double>(i)) / 300.0, 0.0, 1.0);
    const double from_rest = std::clamp((static_cast<double>(i) - 1100.0) / 300.0, 0.0, 1.0);
    const double pace = std::pow(std::max(to_rest, from_rest), 3);
    clock_s += pace / 200.0;
    const double path = 2.4 / 1.7 * std::sin(1.7 * clock_s) + 1.8 / 4.1 * std::sin(4.1 * clock_s + 1.0);
    const double creep = kStep_rad * std::floor(static_cast<double>(i) / 25.0);
    return kStep_rad * std::round((path + creep + pace * Noise(random, 2e-5)) / kStep_rad);
  });
  const std::size_t rows = record.rows();
  for (const std::string& note : Looked(record))
    EXPECT_EQ(note.find("position_rad repeats"), std::string::npos) << note;
  EXPECT_EQ(record.rows(), rows);
}

TEST(LookAtSamplesOfAnAxis, TellsOfSignsThatMakeAnAxisGiveBackWork) {
  Record record = Axis();
  Change(record, "torque_Nm", [](double torque_Nm, std::size_t) { return -torque_Nm; });
  const auto notes = Looked(record);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(notes[0].ends_with(
      "% of the work that passes, where friction takes some: a load drives it, or torque_Nm "
      "or the position has the other sign"))
      << notes[0];
}

TEST(LookAtSamplesOfAnAxis, RefusesARecordThatHardlyHasNewValues) {
  Record record = Axis(200.0);
  Hold(record, "torque_Nm", [](std::size_t i) { return i < 701 || i > 1500; });
  EXPECT_EQ(Refusal(record),
            "r.csv: error: a sensor or logger stood still in 801 of 1600 rows (expected at most 40 %)");
}

}  // namespace
}  // namespace strainwave::bench::look_at_axis_test
