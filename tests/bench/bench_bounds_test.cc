// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/bench_bounds.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/bench/bench_message.h"
#include "tests/schedules/schedule_text.h"

namespace strainwave::bench::bench_bounds_test {
namespace {

using schedules::With;

std::string SmallBench() {
  return R"(bench: 1
name: small
simulated: true
driving_servo: {peak_torque: 7 Nm, peak_speed: 3000 rpm, max_acceleration: 2000 rad/s2}
load_servo: {peak_torque: 7 Nm, peak_speed: 6000 rpm, max_acceleration: 2000 rad/s2}
torque_transducer:
  range: 100 Nm
input_encoder: {counts_per_rev: 1048576, accuracy: 20 arcsec}
output_encoder: {counts_per_rev: 268435456, accuracy: 2.5 arcsec}
accelerometers:
  - name: accel_x
)";
}

TEST(BenchBounds, AreReadableInTheirOwnUnits) {
  for (const auto& bounds : {BenchBounds(), DeviceBounds()}) {
    ASSERT_FALSE(bounds.empty());
    for (const schedules::QuantityBound& bound : bounds) {
      EXPECT_NO_THROW((void)schedules::BeyondBound(bounds, bound.path, bound.dimension, 1e-9)) << bound.path;
      EXPECT_NE(schedules::BeyondBound(bounds, bound.path, bound.dimension, 1e14), "") << bound.path;
      EXPECT_FALSE(bound.reason.empty()) << bound.path;
    }
  }
}

TEST(BenchBounds, RefuseToLeaveShaftsUnwatched) {
  const auto message = [](const std::string& line) {
    return BenchMessageOf(With(SmallBench(), "simulated: true", "simulated: true\n" + line),
                          "small-bench.yaml");
  };
  const std::string unwatched = " (expected no more, since the shafts turn unwatched meanwhile)";
  EXPECT_EQ(message("stale_after: 1 h"),
            "small-bench.yaml:4:14: error: stale_after = 1 h is above 2 s" + unwatched);
  EXPECT_EQ(message("longest_stop_time: 1 min"),
            "small-bench.yaml:4:20: error: longest_stop_time = 1 min is above 10 s" + unwatched);
  const std::string period =
      "since limits are looked at once a period, and drives take set points no faster)";
  EXPECT_EQ(
      message("control_period: 1 s"),
      "small-bench.yaml:4:17: error: control_period = 1 s is above 100 ms (expected no more, " + period);
  EXPECT_EQ(
      message("control_period: 1 us"),
      "small-bench.yaml:4:17: error: control_period = 1 us is below 100 us (expected no less, " + period);
  EXPECT_EQ(message("stale_after: 5 ms"),
            "small-bench.yaml:4:14: error: stale_after = 5 ms is below control_period = "
            "10 ms (expected more, or no reading would ever be fresh)");
  EXPECT_EQ(message("stale_after: 2 s\ncontrol_period: 100 ms"), "");
}

TEST(BenchBounds, KnowTheAccelerometersThatABenchHas) {
  EXPECT_EQ(
      BenchMessageOf(With(SmallBench(), "name: accel_x", "name: accel_front"), "small-bench.yaml"),
      "small-bench.yaml:11:11: error: name = accel_front is none of the accelerometers of a bench (expected "
      "accel_x, accel_y, accel_z, accel_motor_z)");
}

}  // namespace
}  // namespace strainwave::bench::bench_bounds_test
