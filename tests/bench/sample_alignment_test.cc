// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/sample_alignment.h"

#include <cmath>

#include <gtest/gtest.h>

namespace strainwave::bench::sample_alignment_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

double Seconds(nanoseconds time) { return std::chrono::duration<double>(time).count(); }

Readings Taken(nanoseconds torque_time, nanoseconds angles_time) {
  Readings readings;
  readings.torque_time = torque_time;
  readings.angles_time = angles_time;
  readings.output_torque_Nm = 3.0 * Seconds(torque_time);
  readings.input_angle_rad = 80.0 * Seconds(angles_time);
  readings.output_angle_rad = Seconds(angles_time);
  return readings;
}

TEST(SampleAlignment, BringsTorqueAndAnglesToTheOlderOfTheirTimes) {
  for (const auto& [torque_late, angles_late] : {std::pair{milliseconds(7), milliseconds(0)},
                                                 {milliseconds(0), milliseconds(23)},
                                                 {milliseconds(4), milliseconds(4)}}) {
    SampleAlignment alignment;
    for (int step = 10; step < 40; ++step) {
      const nanoseconds now = step * milliseconds(10);
      const auto sample = alignment.Step(Taken(now - torque_late, now - angles_late));
      ASSERT_TRUE(sample);
      if (step < 13) continue;  // nothing is known of the time before
      EXPECT_EQ(sample->time, now - std::max(torque_late, angles_late));
      EXPECT_NEAR(sample->output_torque_Nm, 3.0 * Seconds(sample->time), 1e-12);
      EXPECT_NEAR(sample->input_angle_rad, 80.0 * Seconds(sample->time), 1e-12);
      EXPECT_NEAR(sample->output_angle_rad, Seconds(sample->time), 1e-12);
    }
  }
}

TEST(SampleAlignment, AnswersOnceForEachMoment) {
  SampleAlignment alignment;
  EXPECT_TRUE(alignment.Step(Taken(milliseconds(10), milliseconds(10))));
  EXPECT_FALSE(alignment.Step(Taken(milliseconds(10), milliseconds(20))))
      << "the torque is still that of 10 ms";
  const auto sample = alignment.Step(Taken(milliseconds(30), milliseconds(40)));
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->time, milliseconds(30));
  EXPECT_NEAR(sample->output_angle_rad, 0.03, 1e-12);
}

// A device that was silent for longer than is kept.
TEST(SampleAlignment, TakesTheOldestThatItKeepsForWhatIsOlder) {
  SampleAlignment alignment;
  alignment.Step(Taken(milliseconds(0), milliseconds(0)));
  for (int step = 1; step < 100; ++step) alignment.Step(Taken(milliseconds(0), step * milliseconds(10)));
  const auto sample = alignment.Step(Taken(milliseconds(5), milliseconds(1000)));
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->time, milliseconds(5));
  EXPECT_NEAR(sample->output_angle_rad, 0.69, 1e-12);
}

}  // namespace
}  // namespace strainwave::bench::sample_alignment_test
