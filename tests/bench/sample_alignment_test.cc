// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/sample_alignment.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::bench::sample_alignment_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

double Seconds(nanoseconds time) { return std::chrono::duration<double>(time).count(); }

// What turns at a constant speed and is wound up at a constant rate, as its devices have it at these times.
struct Times {
  nanoseconds torque{}, input{}, output{};
};
Readings Taken(const Times& times) {
  Readings readings;
  readings.input_angle_time = times.input;
  readings.output_angle_time = times.output;
  readings.torque_time = times.torque;
  readings.input_speed_time = readings.motor_torque_time = times.input;
  readings.output_torque_Nm = 3.0 * Seconds(times.torque);
  readings.input_angle_rad = 80.0 * Seconds(times.input);
  readings.output_angle_rad = Seconds(times.output);
  readings.input_speed_rad_per_s = 5.0 * Seconds(times.input);
  readings.motor_torque_Nm = 2.0 * Seconds(times.input);
  return readings;
}

constexpr double kRounding = 1e-12;  // of values of some ten

TEST(SampleAlignment, BringsAllToTheSamplesOfTheOutputAngle) {
  for (const Times& late : {Times{milliseconds(7), milliseconds(0), milliseconds(0)},
                            Times{milliseconds(0), milliseconds(23), milliseconds(0)},
                            Times{milliseconds(0), milliseconds(0), milliseconds(23)},
                            Times{milliseconds(9), milliseconds(3), milliseconds(17)},
                            Times{milliseconds(4), milliseconds(4), milliseconds(4)}}) {
    SampleAlignment alignment;
    int answers = 0;
    for (int step = 10; step < 40; ++step) {
      const nanoseconds now = step * milliseconds(10);
      alignment.Push(Taken({now - late.torque, now - late.input, now - late.output}));
      while (const auto sample = alignment.Next()) {
        ++answers;
        EXPECT_EQ((sample->time + late.output) % milliseconds(10), nanoseconds(0)) << "a sample's own moment";
        EXPECT_LE(sample->time, now - std::max({late.torque, late.input, late.output}))
            << "before all are known";
        EXPECT_EQ(sample->output_angle_rad, Seconds(sample->time));
        EXPECT_NEAR(sample->input_angle_rad, 80.0 * Seconds(sample->time), kRounding);
        EXPECT_NEAR(sample->output_torque_Nm, 3.0 * Seconds(sample->time), kRounding);
        EXPECT_TRUE(sample->has_new_torque);
      }
    }
    // Of 30 steps none is left out but those at either end that lack one of the others.
    EXPECT_GE(answers, 30 - 3);
  }
}

TEST(SampleAlignment, AnswersEachMomentOnceAndInOrder) {
  SampleAlignment alignment;
  alignment.Push(Taken({milliseconds(10), milliseconds(10), milliseconds(10)}));
  ASSERT_EQ(alignment.Next()->time, milliseconds(10));
  EXPECT_FALSE(alignment.Next());
  alignment.Push(Taken({milliseconds(10), milliseconds(20), milliseconds(20)}));
  EXPECT_FALSE(alignment.Next()) << "the torque is still that of 10 ms";
  alignment.Push(Taken({milliseconds(30), milliseconds(30), milliseconds(30)}));
  EXPECT_EQ(alignment.Next()->time, milliseconds(20));
  EXPECT_EQ(alignment.Next()->time, milliseconds(30));
  EXPECT_FALSE(alignment.Next());
}

TEST(SampleAlignment, TellsWhatATorqueOfFewerSamplesSaysNothingNewOf) {
  SampleAlignment alignment;
  std::vector<bool> is_new;
  for (int step = 1; step <= 9; ++step) {
    const nanoseconds now = step * milliseconds(10);
    alignment.Push(Taken({now - now % milliseconds(30), now, now}));
    while (const auto sample = alignment.Next()) is_new.push_back(sample->has_new_torque);
  }
  EXPECT_EQ(is_new, (std::vector<bool>{true, false, true, false, false, true, false, false, true}));
}

TEST(SampleAlignment, BeginsWhereItIsTold) {
  SampleAlignment alignment;
  for (int step = 0; step < 5; ++step) {
    const nanoseconds now = step * milliseconds(10);
    alignment.Push(Taken({now, now, now}));
  }
  alignment.BeginAfter(milliseconds(20));
  EXPECT_EQ(alignment.Next()->time, milliseconds(30));
}

// A speed and a motor torque that come later than all else.
TEST(SampleAlignment, TakesTheNewestOfWhatDelaysNothing) {
  SampleAlignment alignment;
  Readings readings = Taken({milliseconds(10), milliseconds(10), milliseconds(10)});
  alignment.Push(readings);
  const double speed_rad_per_s = readings.input_speed_rad_per_s;
  const double motor_torque_Nm = readings.motor_torque_Nm;
  ASSERT_TRUE(alignment.Next());
  readings.input_angle_time = readings.output_angle_time = readings.torque_time = milliseconds(20);
  alignment.Push(readings);
  const auto sample = alignment.Next();
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->input_speed_rad_per_s, speed_rad_per_s);
  EXPECT_EQ(sample->motor_torque_Nm, motor_torque_Nm);
}

// A device that was silent for longer than is kept: what it tells then says nothing of the moments since.
TEST(SampleAlignment, AnswersNothingOfMomentsThatItHasForgotten) {
  SampleAlignment alignment;
  alignment.Push(Taken({}));
  ASSERT_TRUE(alignment.Next());
  for (int step = 1; step <= 300; ++step) {
    const nanoseconds now = step * milliseconds(10);
    alignment.Push(Taken({milliseconds(0), now, now}));
    EXPECT_FALSE(alignment.Next());
  }
  alignment.Push(Taken({milliseconds(3005), milliseconds(3010), milliseconds(3010)}));
  const auto sample = alignment.Next();
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->time, milliseconds(460)) << "of 301 samples the oldest of the last 256";
  EXPECT_NEAR(sample->output_torque_Nm, 3.0 * 0.46, kRounding);
}

}  // namespace
}  // namespace strainwave::bench::sample_alignment_test
