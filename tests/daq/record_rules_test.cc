// SPDX-License-Identifier: Apache-2.0
#include "daq/record_rules.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "daq/record_error.h"
#include "daq/value_bounds.h"
#include "tests/daq/sample_records.h"

namespace strainwave::daq::record_rules_test {
namespace {

TEST(CheckRecord, FindsNothingWrongInGoodRecords) {
  EXPECT_TRUE(CheckRecord(SampleSweep()).empty());
  EXPECT_TRUE(CheckRecord(SampleLoop()).empty());
  EXPECT_TRUE(CheckRecord(SampleVibration()).empty());
}

Record RecordOf(RecordKind kind, const std::vector<std::string>& columns) {
  Record record{.kind = kind, .metadata = {}, .columns = {}, .source = {}};
  for (const std::string& name : columns) record.columns.push_back({name, std::vector{0.0, 1.0}, "", ""});
  return record;
}

TEST(CheckRecord, KnowsMotorsAndJoints) {
  EXPECT_TRUE(CheckRecord(RecordOf(RecordKind::kMotor, {"current_A", "velocity_rad_per_s"})).empty());
  const std::vector<RuleBreak> motor = CheckRecord(RecordOf(RecordKind::kMotor, {"current_A", "state"}));
  ASSERT_EQ(motor.size(), 1U);
  EXPECT_EQ(motor[0].what, "column 'velocity_rad_per_s' is missing");
  EXPECT_TRUE(CheckRecord(RecordOf(RecordKind::kJoints, {"time_s", "q1_rad", "qd1_rad_per_s", "tau1_Nm",
                                                         "q2_rad", "qd2_rad_per_s", "tau2_Nm"}))
                  .empty());
}

TEST(CheckRecord, WantsTheSameColumnsOfEveryJoint) {
  const std::vector<RuleBreak> gap = CheckRecord(
      RecordOf(RecordKind::kJoints, {"time_s", "q1_rad", "qd1_rad_per_s", "qdd1_rad_per_s2", "tau1_Nm",
                                     "q2_rad", "qd2_rad_per_s", "tau2_Nm", "note", "q_rad", "q01_rad"}));
  ASSERT_EQ(gap.size(), 1U);
  EXPECT_EQ(gap[0].what, "column 'qdd2_rad_per_s2' is missing");
  EXPECT_EQ(gap[0].expected, "the same columns for each of the joints 1 to 2");
  const std::vector<RuleBreak> far = CheckRecord(
      RecordOf(RecordKind::kJoints, {"time_s", "q1_rad", "qd1_rad_per_s", "tau1_Nm", "tau99_Nm"}));
  ASSERT_EQ(far.size(), 1U);
  EXPECT_EQ(far[0].what, "a column has the joint number 99");
}

TEST(CheckRecord, SeesAStepBackBehindANan) {
  Record record = SampleLoop();
  record.columns[0].values = std::vector{5.0, std::nan(""), 4.0};
  const std::vector<RuleBreak> breaks = CheckRecord(record);
  ASSERT_EQ(breaks.size(), 2U);
  EXPECT_EQ(breaks[0].part.row, 1U);
  EXPECT_EQ(breaks[1].part.row, 2U);
  EXPECT_EQ(breaks[1].what, "time_s runs backwards from 5 to 4");
}

TEST(CheckRecord, LetsTimeStandStill) {
  Record record = SampleLoop();
  record.columns[0].values = std::vector{1.0, 1.0, 1.0};
  EXPECT_TRUE(CheckRecord(record).empty());
}

TEST(CheckRecord, StopsCountingInOneColumnButNotInTheNext) {
  Record record = SampleLoop();
  for (Column& column : record.columns) column.values = std::vector<double>(100, std::nan(""));
  EXPECT_EQ(CheckRecord(record).size(), 3 * kMostBreaksPerColumn);
}

TEST(CheckRecord, WantsDirectionsWhereTheyBelongAndNowhereElse) {
  Record record = SampleSweep();
  record.columns[0].values = std::vector{1.0, -1.0};
  ASSERT_EQ(CheckRecord(record).size(), 1U);
  EXPECT_EQ(CheckRecord(record)[0].what, "direction holds numbers");
  record = SampleSweep();
  record.columns[1].values = record.columns[0].values;
  ASSERT_EQ(CheckRecord(record).size(), 1U);
  EXPECT_EQ(CheckRecord(record)[0].what, "input_angle_deg holds directions");
}

TEST(CheckRecord, LooksAtFurtherColumnsOnlyWhereTheyAreChannels) {
  Record loop = SampleLoop();
  loop.columns.push_back({"humidity", std::vector{1.0, std::nan(""), 2.0}, "", ""});
  EXPECT_TRUE(CheckRecord(loop).empty());
  Record vibration = SampleVibration();
  vibration.columns.push_back({"mic_Pa", std::vector{1.0F, NAN, 2.0F}, "", ""});
  ASSERT_EQ(CheckRecord(vibration).size(), 1U);
  EXPECT_EQ(CheckRecord(vibration)[0].what, "mic_Pa is nan");
}

Record SampleMotion() {
  Record record;
  record.kind = RecordKind::kMotion;
  record.columns.push_back({"time_s", std::vector{0.0, 0.1}, "", ""});
  record.columns.push_back({"position_rad", std::vector{0.0, 0.2}, "", ""});
  record.columns.push_back({"current_A", std::vector{1.0, -2.0}, "", ""});
  return record;
}

TEST(CheckRecord, TakesACurrentWithItsGainForATorque) {
  Record record = SampleMotion();
  record.SetMetadata("torque_constant_Nm_per_A", 0.117);
  EXPECT_TRUE(CheckRecord(record).empty());
  EXPECT_EQ(CurrentGain(record), 0.117);
  EXPECT_FALSE(IsLinearAxis(record));
  record.columns[1].name = "position_m";
  ASSERT_EQ(CheckRecord(record).size(), 1U);
  EXPECT_EQ(CheckRecord(record)[0].what, "current_A has no gain");
  EXPECT_EQ(CheckRecord(record)[0].expected,
            "one metadata such as force_constant_N_per_A, or the column force_N");
  record.SetMetadata("force_constant_N_per_A", 30.0);
  EXPECT_TRUE(CheckRecord(record).empty());
  EXPECT_EQ(CurrentGain(record), 30.0);
  EXPECT_TRUE(IsLinearAxis(record));
}

TEST(CheckRecord, WantsOneGainOfACurrentThatIsANumber) {
  Record record = SampleMotion();
  ASSERT_EQ(CheckRecord(record).size(), 1U);
  EXPECT_EQ(CheckRecord(record)[0].what, "current_A has no gain");
  EXPECT_EQ(CheckRecord(record)[0].expected,
            "one metadata such as torque_constant_Nm_per_A, or the column torque_Nm");
  record.SetMetadata("kt_Nm_per_A", "0");
  ASSERT_EQ(CheckRecord(record).size(), 1U);
  EXPECT_EQ(CheckRecord(record)[0].what, "kt_Nm_per_A is '0'");
  EXPECT_EQ(CheckRecord(record)[0].expected, "a number other than zero");
  record.SetMetadata("kt_Nm_per_A", "0.1");
  record.SetMetadata("gain_Nm_per_A", "0.2");
  ASSERT_EQ(CheckRecord(record).size(), 1U);
  EXPECT_EQ(CheckRecord(record)[0].what, "current_A has 2 gains: kt_Nm_per_A, gain_Nm_per_A");
}

TEST(UnitOf, ReadsTheUnitThatANameEndsIn) {
  EXPECT_EQ(UnitOf("torque_Nm"), "Nm");
  EXPECT_EQ(UnitOf("output_angle_deg"), "deg");
  EXPECT_EQ(UnitOf("accel_motor_z_m_per_s2"), "m/s^2");
  EXPECT_EQ(UnitOf("velocity_rad_per_s"), "rad/s");
  EXPECT_EQ(UnitOf("k2_Nm_per_rad"), "Nm/rad");
  EXPECT_EQ(UnitOf("direction"), "");
  EXPECT_EQ(UnitOf("spectrum"), "");
  EXPECT_EQ(UnitOf("odd_"), "");
}

TEST(RecordError, HoldsEveryFindingAndShowsTheFirstTwenty) {
  std::vector<Finding> findings(23, Finding{"f:1:1", "x is bad", "good"});
  const RecordError error(findings);
  EXPECT_EQ(error.findings().size(), 23U);
  const std::string text = error.what();
  EXPECT_TRUE(text.starts_with("f:1:1: error: x is bad (expected good)\n"));
  EXPECT_TRUE(text.ends_with("\nand 3 more errors"));
}

}  // namespace
}  // namespace strainwave::daq::record_rules_test
