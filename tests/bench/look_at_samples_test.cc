// SPDX-License-Identifier: Apache-2.0
// The look at the samples before every command: records of each kind, spoiled as loggers do it, against the
// same records as they were.
#include "bench/records/look_at_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "analysis/units.h"
#include "bench/campaign/campaign_error.h"
#include "bench/campaign/record_results.h"
#include "bench/records/looks.h"

namespace strainwave::bench::look_at_samples_test {
namespace {

using daq::Direction;
using daq::Record;
using Notes = std::vector<daq::RecordNote>;

constexpr int kFirstLine = 4;

void AddColumn(Record& record, const std::string& name, std::vector<double> values) {
  record.columns.push_back({name, std::move(values), "", ""});
}

Record New(const std::string& kind) {
  Record record;
  record.kind = kind;
  record.source = {"r.csv", kFirstLine, ""};
  return record;
}

double Noise(std::mt19937& random, double deviation) {
  return std::normal_distribution(0.0, deviation)(random);
}

// A turn forth and back in steps; 1.2' of range, 0.3' of lost motion.
Record Sweep(double step_deg = 1.0, double ratio = 80.0) {
  std::mt19937 random(5);
  Record record = New("transmission_error");
  std::vector<Direction> direction;
  std::vector<double> input_deg;
  std::vector<double> output_deg;
  const int steps = static_cast<int>(std::lround(360.0 / step_deg));
  for (const int way : {1, -1}) {
    for (int i = 0; i <= steps; ++i) {
      const double at_deg = step_deg * (way > 0 ? i : steps - i);
      const double error_arcmin = 0.6 * std::cos(RadFromDeg(at_deg)) - 0.15 * way + Noise(random, 0.004);
      direction.push_back(way > 0 ? Direction::kClockwise : Direction::kCounterClockwise);
      input_deg.push_back(ratio * at_deg);
      output_deg.push_back(at_deg - error_arcmin / 60.0);
    }
  }
  record.SetMetadata("ratio", ratio);
  record.columns.push_back({"direction", direction, "", ""});
  AddColumn(record, "input_angle_deg", input_deg);
  AddColumn(record, "output_angle_deg", output_deg);
  return record;
}

// Of an axis that is led along sines, with friction: 100 samples a second.
Record Axis(double rate_hz = 100.0, double position_noise_rad = 2e-5, double torque_noise_Nm = 0.04) {
  std::mt19937 random(6);
  Record record = New("motion");
  std::vector<double> time_s;
  std::vector<double> position_rad;
  std::vector<double> torque_Nm;
  for (int i = 0; i < 8.0 * rate_hz; ++i) {
    const double t = i / rate_hz;
    const double speed = 2.4 * std::cos(1.7 * t) + 1.8 * std::cos(4.1 * t + 1.0);
    const double acceleration = -2.4 * 1.7 * std::sin(1.7 * t) - 1.8 * 4.1 * std::sin(4.1 * t + 1.0);
    time_s.push_back(t);
    position_rad.push_back(2.4 / 1.7 * std::sin(1.7 * t) + 1.8 / 4.1 * std::sin(4.1 * t + 1.0) +
                           Noise(random, position_noise_rad));
    torque_Nm.push_back(1e-3 *
                        std::round(1e3 * (0.08 * acceleration + 0.2 * speed + std::copysign(0.9, speed) +
                                          Noise(random, torque_noise_Nm))));
  }
  AddColumn(record, "time_s", time_s);
  AddColumn(record, "position_rad", position_rad);
  AddColumn(record, "torque_Nm", torque_Nm);
  return record;
}

// The same with its velocity, of a resolution; what is beyond `end` reads `end`.
Record AxisWithVelocity(double end_rad_per_s, double step_rad_per_s) {
  std::mt19937 random(8);
  Record record = Axis();
  std::vector<double> velocity;
  for (int i = 0; i < 800; ++i) {
    const double t = i / 100.0;
    const double speed = 2.4 * std::cos(1.7 * t) + 1.8 * std::cos(4.1 * t + 1.0) + Noise(random, 0.01);
    velocity.push_back(step_rad_per_s *
                       std::round(std::clamp(speed, -end_rad_per_s, end_rad_per_s) / step_rad_per_s));
  }
  AddColumn(record, "velocity_rad_per_s", velocity);
  return record;
}

Record Vibration(double rate_hz = 12800.0) {
  std::mt19937 random(7);
  Record record = New("vibration");
  std::vector<double> time_s;
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 4096; ++i) {
    time_s.push_back(i / rate_hz);
    x.push_back(std::sin(kTwoPi * 50.0 * i / rate_hz) + Noise(random, 0.2));
    y.push_back(std::sin(kTwoPi * 100.0 * i / rate_hz) + Noise(random, 0.2));
  }
  AddColumn(record, "time_s", time_s);
  AddColumn(record, "accel_x_m_per_s2", x);
  AddColumn(record, "accel_y_m_per_s2", y);
  return record;
}

void Change(Record& record, const std::string& column,
            const std::function<double(double, std::size_t)>& change) {
  for (daq::Column& one : record.columns) {
    if (one.name != column) continue;
    auto& values = std::get<std::vector<double>>(one.values);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = change(values[i], i);
  }
}

void Wrap(Record& record, const std::string& column, double modulus, double low) {
  Change(record, column,
         [&](double value, std::size_t) { return value - modulus * std::floor((value - low) / modulus); });
}

void Hold(Record& record, const std::string& column, const std::function<bool(std::size_t)>& comes) {
  double last = 0.0;
  Change(record, column,
         [&](double value, std::size_t i) { return last = i == 0 || comes(i) ? value : last; });
}

std::vector<std::string> Looked(Record& record) {
  LookAtSamples(record);
  std::vector<std::string> texts;
  for (const daq::RecordNote& note : record.notes) texts.push_back(note.text);
  return texts;
}

std::string Refusal(Record record) {
  try {
    LookAtSamples(record);
  } catch (const CampaignError& error) {
    return error.what();
  }
  return "taken";
}

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
    EXPECT_EQ(Looked(record), std::vector<std::string>{}) << healthy.kind;
    for (std::size_t c = 0; c < record.columns.size(); ++c)
      EXPECT_EQ(record.columns[c].values, healthy.columns[c].values) << healthy.columns[c].name;
  }
}

TEST(LookAtSamples, LeavesOutSingleSamplesThatNoAxisMovesTo) {
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

TEST(LookAtSamples, LeavesOutAVelocityWhoseRangeEndsTooSoon) {
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

TEST(LookAtSamples, TakesOnlyNewValuesOfAChannelThatIsHeld) {
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

TEST(LookAtSamples, LeavesOutAStretchInWhichASensorStoodStill) {
  Record record = Axis(200.0);
  Hold(record, "torque_Nm", [](std::size_t i) { return i < 701 || i > 760; });
  LookAtSamples(record);
  EXPECT_EQ(record.notes,
            (Notes{{kFirstLine + 700,
                    "61 samples of torque_Nm repeat one value, rows 701 to 761, 3.50 to 3.80 s: a "
                    "sensor or logger that stood still; they are left out"}}));
  EXPECT_EQ(record.rows(), 1600U - 61U);
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

TEST(LookAtSamples, TellsOfSignsThatMakeAnAxisGiveBackWork) {
  Record record = Axis();
  Change(record, "torque_Nm", [](double torque_Nm, std::size_t) { return -torque_Nm; });
  const auto notes = Looked(record);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(notes[0].ends_with(
      "% of the work that passes, where friction takes some: a load drives it, or torque_Nm "
      "or the position has the other sign"))
      << notes[0];
}

TEST(LookAtSamples, RefusesARecordThatHardlyHasNewValues) {
  Record record = Axis(200.0);
  Hold(record, "torque_Nm", [](std::size_t i) { return i < 701 || i > 1500; });
  EXPECT_EQ(Refusal(record),
            "r.csv: error: a sensor or logger stood still in 801 of 1600 rows (expected at most 40 %)");
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
