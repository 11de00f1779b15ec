// SPDX-License-Identifier: Apache-2.0
// What a bench file says of its alarms.
#include <string>

#include <gtest/gtest.h>

#include "bench/configuration/read_bench_file.h"
#include "tests/bench/bench_message.h"

namespace strainwave::bench::alarm_section_test {
namespace {

constexpr const char* kBench = R"(bench: 1
name: small
simulated: true
driving_servo: {peak_torque: 7 Nm, peak_speed: 3000 rpm, max_acceleration: 2000 rad/s2}
load_servo: {peak_torque: 7 Nm, peak_speed: 6000 rpm, max_acceleration: 2000 rad/s2}
torque_transducer: {range: 100 Nm}
input_encoder: {counts_per_rev: 1048576, accuracy: 20 arcsec}
output_encoder: {counts_per_rev: 268435456, accuracy: 2.5 arcsec}
)";

TEST(AlarmSection, SaysWhatToDoAndWhatItLeavesOutIsTheKinds) {
  const BenchDescription bench =
      ParseBenchFile(std::string(kBench) +
                         "alarms:\n"
                         "  - interlock: twist_limit\n"
                         "    guidance: [look at the brake, \"call 4711\"]\n"
                         "  - {interlock: drive_fault, priority: low, latching: true}\n",
                     "small-bench.yaml");
  ASSERT_EQ(bench.alarms.size(), 2U);
  EXPECT_EQ(GuidanceOf("twist_limit", bench.alarms), "look at the brake\ncall 4711");
  EXPECT_EQ(PriorityOf("twist_limit", bench.alarms), AlarmPriority::kHigh);
  EXPECT_TRUE(IsLatching("twist_limit", bench.alarms));
  EXPECT_EQ(GuidanceOf("drive_fault", bench.alarms), KindOf("drive_fault").guidance);
  EXPECT_EQ(PriorityOf("drive_fault", bench.alarms), AlarmPriority::kLow);
  EXPECT_TRUE(IsLatching("drive_fault", bench.alarms));
  EXPECT_EQ(GuidanceOf("vibration_limit", bench.alarms), KindOf("vibration_limit").guidance);
  EXPECT_EQ(PriorityOf("vibration_limit", bench.alarms), AlarmPriority::kHigh);
}

TEST(AlarmKinds, EachSayInASentenceWhatToDoWhereTheBenchFileDoesNot) {
  for (const AlarmKind& kind : kAlarmKinds) {
    const std::string guidance = GuidanceOf(kind.code, {});
    EXPECT_TRUE(guidance.size() > 30 && guidance.ends_with('.')) << kind.code << ": " << guidance;
    EXPECT_EQ(guidance.find('\n'), guidance.npos) << kind.code;
    // A limit of the specimen stays until somebody confirms it: that is said.
    EXPECT_EQ(guidance.find("Confirm when") != guidance.npos, kind.latching) << kind.code;
  }
  EXPECT_EQ(GuidanceOf("of a later version", {}), "");
}

TEST(AlarmSection, RefusesAlarmsThatThereAreNot) {
  const std::string message = BenchMessageOf(std::string(kBench) +
                                                 "alarms:\n"
                                                 "  - {interlock: twist, guidance: x}\n"
                                                 "  - {interlock: drive_fault, priority: urgent}\n"
                                                 "  - {interlock: drive_fault, limit: 5 Nm}\n",
                                             "small-bench.yaml");
  std::string kinds;
  for (const AlarmKind& kind : kAlarmKinds) kinds += (kinds.empty() ? "" : ", ") + std::string(kind.code);
  EXPECT_EQ(message,
            "small-bench.yaml:10:17: error: interlock = twist is no kind of alarm (expected one of " + kinds +
                ")\n"
                "small-bench.yaml:11:40: error: priority = urgent: not known (expected low, medium or high)\n"
                "small-bench.yaml:12:17: error: interlock 'drive_fault' is there twice (expected once; it is "
                "already on line 11)\n"
                "small-bench.yaml:12:30: error: unknown key 'limit' (expected interlock, priority, latching, "
                "guidance)");
}

}  // namespace
}  // namespace strainwave::bench::alarm_section_test
