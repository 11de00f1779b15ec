// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/generated_loop.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::diagnosis::diagnosis_bad_input_test {
namespace {

using Texts = std::vector<std::string>;

HysteresisData Loop(double peak_Nm = 34.0) {
  std::vector<PathLeg> path;
  for (int loop = 0; loop < 2; ++loop) {
    path.push_back({.to_Nm = peak_Nm, .rate_Nm_per_s = 1.0});
    path.push_back({.to_Nm = -peak_Nm, .rate_Nm_per_s = 1.0});
  }
  return GenerateLoop({}, {}, path, 1500, 9);
}

Texts WarningsOf(const HysteresisData& record) { return MakeHysteresisStudy({&record, 1})->warnings(); }
std::string MessageOf(const HysteresisData& record) { return RefusalOf(&MakeHysteresisStudy, record); }

TEST(BadHysteresis, TorqueThatSaturatesIsRefused) {
  HysteresisData record = Loop();
  for (double& torque_Nm : record.torque_Nm) torque_Nm = std::clamp(torque_Nm, -50.0, 28.0);
  EXPECT_EQ(MessageOf(record),
            "torque_Nm is saturated: 152 samples read 28 Nm, its largest value, while the angle goes on and "
            "comes back (expected a transducer or an amplifier with room beyond the peak torque)");
}

// The loop is as wide as the twist goes on beyond the end of the range.
TEST(BadHysteresis, TorqueOfAWideLoopThatSaturatesALittleIsRefused) {
  HysteresisData record = GenerateLoop({.friction_Nm = {4.0}}, {.torque_noise_Nm = 0.05},
                                       {{.to_Nm = 34.0}, {.to_Nm = -34.0}, {.to_Nm = 34.0}}, 700, 12);
  for (double& torque_Nm : record.torque_Nm) torque_Nm = std::min(1e-4 * std::round(1e4 * torque_Nm), 31.5);
  EXPECT_EQ(MessageOf(record),
            "torque_Nm is saturated: 31 samples read 31.5 Nm, its largest value, while the angle goes on and "
            "comes back (expected a transducer or an amplifier with room beyond the peak torque)");
}

TEST(BadHysteresis, TorqueThatNeverComesBackIsRefused) {
  HysteresisData record = Loop();
  const auto peak = static_cast<std::size_t>(
      std::max_element(record.torque_Nm.begin(), record.torque_Nm.end()) - record.torque_Nm.begin());
  for (auto* column : {&record.time_s, &record.torque_Nm, &record.output_angle_rad}) column->resize(peak);
  EXPECT_EQ(MessageOf(record), "torque_Nm goes from -0.02285 to 33.8 Nm and never back (expected a loop)");
}

TEST(BadHysteresis, TimeThatStandsStillIsRefused) {
  HysteresisData record = Loop();
  record.time_s.assign(record.time_s.size(), 3.0);
  EXPECT_EQ(MessageOf(record), "time_s stands still (expected it to rise)");
}

TEST(BadHysteresis, KneesOutOfOrderAreRefused) {
  HysteresisData record = Loop();
  std::swap(record.t1_Nm, record.t2_Nm);
  EXPECT_EQ(MessageOf(record),
            "t1_Nm = 25, t2_Nm = 7, t3_Nm = 34 are out of order (expected 0 < t1 < t2 <= t3)");
}

TEST(BadHysteresis, RecordsOfTwoGearsAreRefused) {
  std::vector<HysteresisData> records{Loop(), Loop()};
  records[1].t1_Nm = 3.5;
  EXPECT_EQ(analysis::MessageOf([&] { MakeHysteresisStudy(records); }),
            "records differ in their knees: t1_Nm = 7, t2_Nm = 25 and t1_Nm = 3.5, t2_Nm = 25 (expected one "
            "gear in all of them)");
}

TEST(BadHysteresis, ATwistThatNoGearOfTheSizeHasIsTold) {
  HysteresisData record = Loop();
  for (double& angle : record.output_angle_rad) angle *= 2.0 * kPi;
  EXPECT_EQ(
      WarningsOf(record).front(),
      "twist per torque is 6.4 times what a gear with t3 = 34 Nm has: look at the units of torque_Nm and "
      "output_angle_deg");
}

TEST(BadHysteresis, AnglesInAnotherUnitAreTold) {
  HysteresisData record = Loop();
  for (double& angle : record.output_angle_rad) angle *= 60.0;
  EXPECT_EQ(WarningsOf(record), Texts{"output_angle_deg looks like arcmin: the twist is about 61 times what "
                                      "a gear with t3 = 34 Nm has (1 deg = 60 arcmin)"});
  record = Loop();
  for (double& angle : record.output_angle_rad) angle = RadFromDeg(angle);
  EXPECT_EQ(WarningsOf(record), Texts{"output_angle_deg looks like rad: the twist is about 56 times smaller "
                                      "than what a gear with t3 = 34 Nm has (1 rad = 57.3 deg)"});
}

TEST(BadHysteresis, TorqueInAnotherUnitIsTold) {
  HysteresisData record = Loop();
  for (double& torque_Nm : record.torque_Nm) torque_Nm *= 1000.0;
  EXPECT_EQ(WarningsOf(record),
            (Texts{"twist per torque is 0.001 times what a gear with t3 = 34 Nm has: look at the units of "
                   "torque_Nm and output_angle_deg",
                   "torque goes up to 3.399e+04 Nm, 1e+03 times t3_Nm: look at the units of torque_Nm"}));
}

TEST(BadHysteresis, ASignThatIsSwappedIsToldAndPutRight) {
  HysteresisData record = Loop();
  for (double& torque_Nm : record.torque_Nm) torque_Nm = -torque_Nm;
  EXPECT_EQ(WarningsOf(record),
            Texts{"the angle falls with the torque: the sign of one of them is swapped; torque is taken with "
                  "the other sign"});
  const Diagnosed found = DiagnoseRecords(&MakeHysteresisStudy, std::vector<HysteresisData>{record});
  EXPECT_EQ(found.diagnosis.verdict, Verdict::kNoEffect);
}

TEST(BadHysteresis, WhatALoopCannotShowIsTold) {
  EXPECT_EQ(WarningsOf(Loop(20.0)),
            Texts{"torque goes up to 19.99 Nm and never beyond t2_Nm = 25: K3 cannot be seen"});
  HysteresisData record = Loop();
  for (double& torque_Nm : record.torque_Nm) torque_Nm = std::abs(torque_Nm);
  for (double& angle : record.output_angle_rad) angle = std::abs(angle);
  EXPECT_EQ(WarningsOf(record).front(),
            "torque goes to one side only (0.008643 to 33.99 Nm): what differs between the two sides cannot "
            "be seen");
}

TEST(BadHysteresis, TimeStampsThatRepeatOrJitterMakeNoCause) {
  HysteresisData record = Loop();
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> jitter(-0.45, 0.45);
  const double step_s = record.time_s[1] - record.time_s[0];
  for (double& time_s : record.time_s) time_s += jitter(engine) * step_s;
  for (std::size_t i = 10; i + 1 < record.time_s.size(); i += 10) record.time_s[i + 1] = record.time_s[i];
  const Diagnosed found = DiagnoseRecords(&MakeHysteresisStudy, std::vector<HysteresisData>{record});
  EXPECT_EQ(found.diagnosis.verdict, Verdict::kNoEffect);
}

// An axis that swings, 4 ms a sample.
MotionData Swing() {
  MotionData record;
  std::mt19937 engine(3);
  std::normal_distribution<double> noise(0.0, 0.02);
  for (int i = 0; i < 5000; ++i) {
    const double time_s = 0.004 * i;
    const double turn = 1.7 * std::sin(1.3 * time_s) + 0.9 * std::sin(3.1 * time_s);
    const double speed = 2.21 * std::cos(1.3 * time_s) + 2.79 * std::cos(3.1 * time_s);
    const double pull = -2.873 * std::sin(1.3 * time_s) - 8.649 * std::sin(3.1 * time_s);
    record.time_s.push_back(time_s);
    record.position.push_back(turn);
    record.velocity.push_back(speed);
    record.torque.push_back(0.2 * pull + 0.3 * speed + (speed < 0.0 ? -0.5 : 0.5) + noise(engine));
  }
  return record;
}

Texts WarningsOf(const MotionData& record) { return MakeMotionStudy({&record, 1})->warnings(); }
std::string MessageOf(const MotionData& record) { return RefusalOf(&MakeMotionStudy, record); }
bool Says(const Texts& texts, const std::string& text) {
  return std::ranges::find(texts, text) != texts.end();
}

TEST(BadMotion, ATorqueOfTheOtherSignIsTold) {
  MotionData record = Swing();
  for (double& torque_Nm : record.torque) torque_Nm = -torque_Nm;
  EXPECT_TRUE(Says(WarningsOf(record),
                   "the inertia comes out negative: the position or the torque has the other sign"))
      << testing::PrintToString(WarningsOf(record));
}

TEST(BadMotion, AVelocityInAnotherUnitIsToldAndPutRight) {
  MotionData record = Swing();
  for (double& speed : record.velocity) speed *= 30.0 / kPi;
  EXPECT_TRUE(Says(WarningsOf(record),
                   "the velocity column is 9.549 times the position's rate: it looks like revolutions per "
                   "minute, not rad/s; converted"))
      << testing::PrintToString(WarningsOf(record));
  record = Swing();
  for (double& angle : record.position) angle = DegFromRad(angle);
  EXPECT_TRUE(Says(
      WarningsOf(record),
      "the position goes 57.3 times as far as the velocity says: it looks like degrees, not rad; converted"))
      << testing::PrintToString(WarningsOf(record));
  record = Swing();
  for (double& speed : record.velocity) speed *= 2.5;
  EXPECT_TRUE(
      Says(WarningsOf(record),
           "the velocity column is 2.5 times the position's rate, which is no unit that we know: left "
           "out"))
      << testing::PrintToString(WarningsOf(record));
}

TEST(BadMotion, AGapIsNoOtherUnit) {
  MotionData record = Swing();
  for (auto* column : {&record.time_s, &record.position, &record.velocity, &record.torque}) {
    column->erase(column->begin() + 1800, column->begin() + 2400);
  }
  EXPECT_EQ(WarningsOf(record),
            Texts{"1 gap of more than 3.5 steps: what lies between is taken piece by piece"});
}

TEST(BadMotion, TorqueThatSaturatesIsLeftOutOrRefused) {
  MotionData record = Swing();
  for (double& torque : record.torque) torque = std::clamp(torque, -0.8, 0.8);
  EXPECT_EQ(MessageOf(record),
            "67 % of the samples stand at the end of the torque's range (-0.8 to 0.8 Nm): saturated "
            "(expected a record inside the range)");
  record = Swing();
  for (double& torque : record.torque) torque = std::clamp(torque, -1.8, 1.8);
  EXPECT_TRUE(Says(WarningsOf(record),
                   "36 % of the samples stand at the end of the torque's range (-1.8 to 1.8 Nm): saturated; "
                   "they are left out"))
      << testing::PrintToString(WarningsOf(record));
}

TEST(BadMotion, TimeStampsThatRepeatAreTold) {
  MotionData record = Swing();
  for (std::size_t i = 10; i + 3 < record.time_s.size(); i += 10) {
    for (std::size_t k = 1; k <= 3; ++k) record.time_s[i + k] = record.time_s[i];
  }
  EXPECT_TRUE(
      Says(WarningsOf(record),
           "1497 time stamps repeat the one before with other values: spread evenly up to the next one"))
      << testing::PrintToString(WarningsOf(record));
}

// Stamps of a clock that ticks every 8 ms, now and then too late for a sample: all in all the record is even.
TEST(BadMotion, TimeStampsOfASlowClockAreTold) {
  MotionData record = Swing();
  record.velocity.clear();
  for (std::size_t i = 0; i < record.time_s.size(); ++i) {
    const double late_s = i % 97 == 0 ? 5e-4 : 0.0;
    record.time_s[i] = 0.008 * std::floor((record.time_s[i] - late_s + 1e-9) / 0.008);
  }
  const Texts told{
      "2499 time stamps repeat the one before with other values: within a tick of the clock of even steps, "
      "which take their place"};
  EXPECT_EQ(WarningsOf(record), told);
  // Columns so coarse that rows are alike now and then do not make samples of them that were logged twice.
  for (double& position : record.position) position = 1e-3 * std::round(1e3 * position);
  for (double& torque : record.torque) torque = 0.1 * std::round(10.0 * torque);
  EXPECT_TRUE(Says(WarningsOf(record), told.front())) << testing::PrintToString(WarningsOf(record));
}

// A shaft at 1500 rpm with its own two lines, 0.2 ms a sample.
VibrationData Hum() {
  VibrationData record;
  std::mt19937 engine(3);
  std::normal_distribution<double> noise(0.0, 0.05);
  record.channels.push_back({"accel_x_m_per_s2", {}});
  for (int i = 0; i < 5000; ++i) {
    const double angle_rad = kTwoPi * 25.0 * 2e-4 * i;
    record.time_s.push_back(2e-4 * i);
    record.channels[0].values.push_back(std::cos(angle_rad) + 0.5 * std::cos(2.0 * angle_rad) +
                                        noise(engine));
  }
  record.input_speed_rad_per_s = {kTwoPi * 25.0};
  return record;
}

Texts WarningsOf(const VibrationData& record) { return MakeVibrationStudy({&record, 1})->warnings(); }
std::string MessageOf(const VibrationData& record) { return RefusalOf(&MakeVibrationStudy, record); }

TEST(BadVibration, TimeStampsThatRepeatOrJitterAreTold) {
  VibrationData record = Hum();
  for (std::size_t i = 10; i + 1 < record.time_s.size(); i += 10) record.time_s[i + 1] = record.time_s[i];
  EXPECT_TRUE(Says(WarningsOf(record),
                   "10.0 % of the time stamps repeat the one before: the samples are taken as evenly spaced"))
      << testing::PrintToString(WarningsOf(record));
  record = Hum();
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> jitter(-4e-5, 4e-5);
  for (double& time_s : record.time_s) time_s += jitter(engine);
  EXPECT_TRUE(Says(
      WarningsOf(record),
      "the time stamps jitter by 16 % of the sampling period: lines near half the sampling rate are smeared"))
      << testing::PrintToString(WarningsOf(record));
}

TEST(BadVibration, AChannelThatIsClippedIsToldOrRefused) {
  VibrationData record = Hum();
  for (double& value : record.channels[0].values) value = std::min(value, 1.535);
  EXPECT_TRUE(Says(WarningsOf(record),
                   "accel_x_m_per_s2 is clipped: 1.0 % of its samples stand at the end of the range, 1.535; "
                   "odd multiples of strong lines may come from that"))
      << testing::PrintToString(WarningsOf(record));
  record = Hum();
  for (double& value : record.channels[0].values) value = std::clamp(value, -0.3, 0.3);
  EXPECT_EQ(MessageOf(record),
            "accel_x_m_per_s2 is clipped: 87.7 % of its samples stand at the end of the range, 0.3 (expected "
            "a range that holds the vibration)");
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_bad_input_test
