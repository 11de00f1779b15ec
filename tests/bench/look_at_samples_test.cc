// SPDX-License-Identifier: Apache-2.0
// The look at the samples before every command: records of each kind, spoiled as loggers do it, against the
// same records as they were.
#include "bench/records/look_at_samples.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "analysis/units.h"
#include "bench/campaign/record_results.h"
#include "bench/records/looks.h"
#include "tests/bench/logged_records.h"

namespace strainwave::bench::look_at_samples_test {
namespace {

using namespace logged_records;

void ExpectSameError(const Record& looked, const Record& as_it_was) {
  const auto found = TransmissionErrorOf(looked, {});
  const auto truth = TransmissionErrorOf(as_it_was, {});
  EXPECT_EQ(found.failed_checks, truth.failed_checks);
  EXPECT_NEAR(found.cw->e_avg_rad.value, truth.cw->e_avg_rad.value, 1e-11);
  EXPECT_NEAR(found.cw->e_max_rad.value, truth.cw->e_max_rad.value, 1e-11);
  EXPECT_NEAR(found.lost_motion_rad->value, truth.lost_motion_rad->value, 1e-11);
}

TEST(LookAtSamples, SaysNothingOfHealthyRecordsAndLeavesThemAsTheyAre) {
  for (const Record& healthy : {Sweep(), Sweep(5.0, -100.0), Axis(), Axis(1000.0), Vibration()}) {
    Record record = healthy;
    EXPECT_EQ(Looked(record), std::vector<std::string>{}) << healthy.kind.name();
    for (std::size_t c = 0; c < record.columns.size(); ++c)
      EXPECT_EQ(record.columns[c].values, healthy.columns[c].values) << healthy.columns[c].name;
  }
}

TEST(LookAtSamples, MakesAnglesOfOneTurnGoOn) {
  for (const double low_deg : {0.0, -180.0}) {
    for (const double step_deg : {0.25, 1.0, 3.0}) {
      for (const double ratio : {80.0, -120.0}) {
        const Record as_it_was = Sweep(step_deg, ratio);
        Record record = as_it_was;
        Wrap(record, "output_angle_deg", 360.0, low_deg);
        Wrap(record, "input_angle_deg", 360.0, low_deg);
        LookAtSamples(record);
        EXPECT_EQ(record.notes.size(), 2U) << low_deg << " " << step_deg << " " << ratio;
        ExpectSameError(record, as_it_was);
      }
    }
  }
}

TEST(LookAtSamples, KnowsTheMeanOfAbsoluteAnglesOfOneTurn) {
  for (const double ratio : {80.0, -120.0}) {
    Record as_it_was = Sweep(1.0, ratio);
    as_it_was.SetMetadata("absolute", "true");
    Change(as_it_was, "output_angle_deg", [](double deg, std::size_t) { return deg + 217.0; });
    Change(as_it_was, "input_angle_deg", [&](double deg, std::size_t) { return deg + 217.0 * ratio; });
    for (const bool output_too : {true, false}) {
      Record record = as_it_was;
      if (output_too) Wrap(record, "output_angle_deg", 360.0, -180.0);
      Wrap(record, "input_angle_deg", 360.0, 0.0);
      LookAtSamples(record);
      ExpectSameError(record, as_it_was);
    }
  }
}

TEST(LookAtSamples, SaysWhereAnAngleStartsAnew) {
  Record record = Sweep();
  Wrap(record, "output_angle_deg", 360.0, -180.0);
  LookAtSamples(record);
  EXPECT_EQ(record.notes,
            (Notes{{kFirstLine + 180,
                    "output_angle_deg starts anew every 360 deg, 2 times in the record, first at row "
                    "181: taken as going on"}}));
}

TEST(LookAtSamples, RefusesStepsThatCouldBeTheOtherWay) {
  Record record = Sweep(3.0, 100.0);  // 300 deg of the input a row, or 60 the other way
  record.SetMetadata("ratio", 80.0);
  Wrap(record, "input_angle_deg", 360.0, 0.0);
  EXPECT_EQ(Refusal(record),
            "r.csv:5: error: input_angle_deg starts anew every 360 deg at row 2, and goes by 60 deg from row "
            "to row: "
            "which way cannot be told (expected steps of less than 36 deg, or an angle that goes on)");
}

TEST(LookAtSamples, RefusesAWrongRatioForEveryCommand) {
  Record record = Sweep();
  record.SetMetadata("ratio", 80.5);
  EXPECT_EQ(Refusal(record),
            "r.csv: error: ratio looks like 80, file says 80.5 (expected ratio = input angle / output angle, "
            "signed)");
  record.SetMetadata("ratio", -80.0);
  EXPECT_EQ(Refusal(record),
            "r.csv: error: ratio looks like 80, file says -80 (expected ratio = input angle / output angle, "
            "signed)");
}

TEST(LookAtSamples, LetsASweepStandStillAsLongAsItLikes) {
  const Record as_it_was = Sweep();
  Record record = as_it_was;
  std::mt19937 random(9);
  for (daq::Column& column : record.columns) {
    if (auto* directions = std::get_if<std::vector<Direction>>(&column.values)) {
      directions->insert(directions->begin(), 20000, directions->front());
      continue;
    }
    auto& values = std::get<std::vector<double>>(column.values);
    const double first = values.front();
    values.insert(values.begin(), 20000, first);
    for (std::size_t i = 1; i < 20000; ++i) values[i] += Noise(random, 1e-5);
  }
  EXPECT_EQ(Looked(record),
            (std::vector<std::string>{"the output stands still in rows 1 to 20001: they count by the "
                                      "angle, not by their number"}));
  const auto found = TransmissionErrorOf(record, {});
  EXPECT_EQ(found.failed_checks, std::vector<std::string>{});
  EXPECT_NEAR(ArcminFromRad(found.cw->e_avg_rad.value),
              ArcminFromRad(TransmissionErrorOf(as_it_was, {}).cw->e_avg_rad.value), 0.002);
}

TEST(LookAtSamples, LeavesOutAnAngleThatStoodStillWhileTheOtherShaftWentOn) {
  Record record = Sweep();
  Hold(record, "input_angle_deg", [](std::size_t i) { return i < 101 || i > 111; });
  LookAtSamples(record);
  EXPECT_EQ(record.notes,
            (Notes{{kFirstLine + 100,
                    "12 samples of input_angle_deg repeat one value, rows 101 to 112: a sensor or "
                    "logger that stood still; they are left out"}}));
  EXPECT_EQ(record.rows(), 722U - 12U);
}

// Rows are four times as dense there as elsewhere: 41 of them are no longer a way than ten others.
TEST(LookAtSamples, LeavesOutAnAngleThatStoodStillWhereASweepIsSlow) {
  Record record = Sweep(0.25);
  std::vector<bool> kept;
  for (std::size_t i = 0; i < record.rows(); ++i) kept.push_back(i % 4 == 0 || (i > 400 && i < 800));
  KeepRows(record, kept);
  Hold(record, "input_angle_deg", [](std::size_t i) { return i < 201 || i > 240; });
  LookAtSamples(record);
  EXPECT_EQ(
      record.notes,
      (Notes{{kFirstLine + 200,
              "41 samples of input_angle_deg repeat one value, rows 201 to 241: a sensor or logger that "
              "stood still; they are left out"}}));
  EXPECT_NEAR(ArcminFromRad(TransmissionErrorOf(record, {}).cw->e_max_rad.value), 1.2, 0.05);
}

TEST(LookAtSamples, TakesOnlyNewValuesOfAnAngleThatIsHeldInASweep) {
  Record record = Sweep();
  Hold(record, "input_angle_deg", [](std::size_t i) { return i % 3 == 0; });
  const auto notes = Looked(record);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(
      notes[0].starts_with("input_angle_deg repeats its value until the next one comes, in 481 of 722 rows"))
      << notes[0];
  const auto found = TransmissionErrorOf(record, {});
  EXPECT_NEAR(ArcminFromRad(found.cw->e_max_rad.value), 1.2, 0.03);
}

TEST(LookAtSamples, LeavesOutTheChannelOfAVibrationThatIsHeld) {
  Record record = Vibration();
  Hold(record, "accel_y_m_per_s2", [](std::size_t i) { return i % 2 == 0; });
  EXPECT_EQ(Looked(record),
            (std::vector<std::string>{
                "accel_y_m_per_s2 repeats its value until the next one comes, in 2048 of 4096 rows, up "
                "to 2 rows long; it is left out"}));
  EXPECT_EQ(record.FindColumn("accel_y_m_per_s2"), nullptr);
  EXPECT_EQ(record.rows(), 4096U);
}

TEST(LookAtSamples, TakesAVibrationAtTheRateOfItsValues) {
  Record record = Vibration();
  record.SetMetadata("sample_rate_hz", 12800.0);
  std::erase_if(record.columns, [](const daq::Column& column) { return column.name == "time_s"; });
  for (const char* column : {"accel_x_m_per_s2", "accel_y_m_per_s2"})
    Hold(record, column, [](std::size_t i) { return i % 4 == 0; });
  EXPECT_EQ(Looked(record).size(), 2U);
  EXPECT_EQ(record.rows(), 1024U);
  EXPECT_EQ(record.Metadata("sample_rate_hz"), "3200");
}

TEST(LookAtSamples, TakesRoundedStampsOfAVibrationAsEven) {
  Record record = Vibration();
  Change(record, "time_s", [](double time_s, std::size_t) { return 1e-4 * std::round(time_s / 1e-4); });
  EXPECT_EQ(Looked(record), (std::vector<std::string>{
                                "21.9 % of the time stamps repeat the one before: all within a tick of even "
                                "steps, which take their place"}));
  for (std::size_t i = 0; i < record.rows(); ++i)
    ASSERT_NEAR(record.Doubles("time_s")[i], static_cast<double>(i) / 12800.0, 1e-5);
}

TEST(LookAtSamples, SaysWhatSettlesStampsThatNobodyCanRead) {
  Record record = Vibration();
  Change(record, "time_s", [](double, std::size_t i) {
    return 1e-4 * std::round((static_cast<double>(i) + 40.0 * std::sin(0.01 * static_cast<double>(i))) /
                             12800.0 / 1e-4);
  });
  const std::string refusal = Refusal(record);
  EXPECT_TRUE(refusal.ends_with(
      "of the time stamps repeat the one before (expected even steps; sample_rate_hz in the "
      "metadata settles it)"))
      << refusal;
  record.SetMetadata("sample_rate_hz", 12800.0);
  const auto notes = Looked(record);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(notes[0].ends_with("repeat the one before: sample_rate_hz, 12800, takes their place"))
      << notes[0];
}

Record Loop(double peak_deg, double step_deg) {
  Record record = New("hysteresis");
  record.SetMetadata("t1_Nm", 7.0);
  record.SetMetadata("t2_Nm", 25.0);
  record.SetMetadata("t3_Nm", 34.0);
  std::mt19937 random(4);
  std::vector<double> time_s;
  std::vector<double> torque_Nm;
  std::vector<double> angle_deg;
  for (int i = 0; i <= 1200; ++i) {
    const double quarter = i / 240.5;  // up, down, up
    const double share = quarter < 1.0 ? quarter : quarter < 3.0 ? 2.0 - quarter : quarter - 4.0;
    const double at_deg = peak_deg * share + Noise(random, 1e-5);
    time_s.push_back(0.1 * i);
    torque_Nm.push_back(34.0 * share + Noise(random, 0.02));
    angle_deg.push_back(step_deg > 0.0 ? step_deg * std::round(at_deg / step_deg) : at_deg);
  }
  AddColumn(record, "time_s", time_s);
  AddColumn(record, "torque_Nm", torque_Nm);
  AddColumn(record, "output_angle_deg", angle_deg);
  return record;
}

// Of 14 bits a turn a whole loop holds a handful of steps, too few changes to see a step in them.
TEST(LookAtSamples, SaysThatALoopStandsOnSteps) {
  for (const double bits : {14.0, 18.0}) {
    const double step_deg = 360.0 / std::exp2(bits);
    Record record = Loop(0.07, step_deg);
    const double steps = 2.0 * std::round(0.07 / step_deg);
    EXPECT_EQ(Looked(record),
              std::vector<std::string>{fmt::format("output_angle_deg stands on steps of {:.3g} deg, {:.0f} "
                                                   "from end to end: nothing finer can be told apart",
                                                   step_deg, steps)});
  }
}

TEST(LookAtSamples, DoesNotTakeAnEvenRampForSteps) {
  Record record = Loop(0.17, 0.0);
  EXPECT_EQ(Looked(record), std::vector<std::string>{});
}

// A commanded load without noise, in ramps of some rows, whose corners fall between rows, and rests of nine.
Record Stairs(double Nm_a_row) {
  std::vector<double> time_s, torque_Nm, angle_deg;
  std::mt19937 random(5);
  const std::vector<double> levels{0.0, 7.0, 14.0, 20.4, 27.2, 34.0};
  std::vector<double> stairs{levels.begin(), levels.end()};
  for (const double sign : {-1.0, 1.0}) {
    for (std::size_t k = 0; k + 1 < 2 * levels.size(); ++k) {
      const double level = levels[k < levels.size() ? levels.size() - 1 - k : k - levels.size() + 1];
      stairs.push_back(k < levels.size() ? -sign * level : sign * level);
    }
  }
  double torque = 0.0;
  for (const double level : stairs) {
    while (std::abs(level - torque) > 0.05) {
      torque += std::clamp(level - torque, -Nm_a_row, Nm_a_row);
      torque_Nm.push_back(std::round(1e5 * torque) / 1e5);
    }
    torque_Nm.insert(torque_Nm.end(), 9, torque_Nm.empty() ? 0.0 : torque_Nm.back());
  }
  for (const double value : torque_Nm) {
    time_s.push_back(0.04 * static_cast<double>(time_s.size()));
    angle_deg.push_back(0.0018 * value + Noise(random, 1e-4));
  }
  Record record;
  record.kind = daq::RecordKind::kHysteresis;
  AddColumn(record, "time_s", time_s);
  AddColumn(record, "torque_Nm", torque_Nm);
  AddColumn(record, "output_angle_deg", angle_deg);
  return record;
}

TEST(LookAtSamples, LetsALoadRestOnItsStairs) {
  for (const double Nm_a_row : {1.27, 2.9}) {
    Record record = Stairs(Nm_a_row);
    const std::size_t rows = record.rows();
    EXPECT_EQ(Looked(record), std::vector<std::string>{});
    EXPECT_EQ(record.rows(), rows);
  }
}

TEST(LookAtSamples, RefusesARateThatContradictsTheTime) {
  Record record = Vibration();
  record.SetMetadata("sample_rate_hz", 48000.0);
  EXPECT_EQ(Refusal(record),
            "r.csv: error: sample_rate_hz is 48000, but time_s goes on by 12800 samples a second (expected "
            "one rate)");
  record.SetMetadata("sample_rate_hz", 12800.0);
  EXPECT_EQ(Refusal(record), "taken");
}

}  // namespace
}  // namespace strainwave::bench::look_at_samples_test
