// SPDX-License-Identifier: Apache-2.0
// A sensor whose calibration the bench file copies from its data sheet.
#include <string>

#include <gtest/gtest.h>

#include "bench/configuration/read_bench_file.h"
#include "tests/bench/bench_message.h"
#include "tests/schedules/schedule_text.h"

namespace strainwave::bench::teds_section_test {
namespace {

using schedules::With;

// The bytes are put together by hand in tests/daq/acquisition/calibration_test.cc: manufacturer 43, model
// 7115, version C12, serial number 1 234 567.
std::string BenchWithTeds() {
  return R"(bench: 1
name: with data sheets
simulated: true
driving_servo: {peak_torque: 7 Nm, peak_speed: 3000 rpm, max_acceleration: 2000 rad/s2}
load_servo: {peak_torque: 7 Nm, peak_speed: 6000 rpm, max_acceleration: 2000 rad/s2}
torque_transducer: {range: 100 Nm}
input_encoder: {counts_per_rev: 1048576, accuracy: 20 arcsec}
output_encoder: {counts_per_rev: 268435456, accuracy: 2.5 arcsec}
accelerometers:
  - name: accel_x
    serial: "1234567"
    teds:
      basic: 2B C0 F2 66 30 87 D6 12
      counts_per_volt: 3276.8
      fields: {"%Sens@Ref": 0.0102, "%Sign": "-", "%CalDate": 2026-03-01, "%CalPeriod": 365}
)";
}

std::string MessageOf(std::string_view from, std::string_view to) {
  return BenchMessageOf(With(BenchWithTeds(), from, to), "lab.yaml", "lab");
}

TEST(TedsSection, GivesASensorItsCalibration) {
  const BenchDescription bench = ParseBenchFile(BenchWithTeds(), "lab.yaml", "lab");
  const AccelerometerDescription& sensor = bench.accelerometers.at(0);
  EXPECT_EQ(sensor.serial, "1234567");
  EXPECT_EQ(sensor.calibration, "TEDS 1234567 C12 2026-03-01");
  EXPECT_EQ(sensor.calibration_due, "2027-03-01");
  ASSERT_TRUE(sensor.teds);
  EXPECT_DOUBLE_EQ(sensor.teds->sensitivity, -0.0102 * 3276.8);
  EXPECT_FALSE(bench.transducer.teds);
  // Who mounts it need not write the number down once more.
  EXPECT_EQ(ParseBenchFile(With(BenchWithTeds(), "    serial: \"1234567\"\n", ""), "lab.yaml", "lab")
                .accelerometers.at(0)
                .serial,
            "1234567");
}

TEST(TedsSection, RefusesADataSheetThatIsNone) {
  EXPECT_EQ(
      MessageOf("basic: 2B C0", "basic: 10 C0"),
      "lab.yaml:13:14: error: Manufacturer ID = 16 is not between 17 and 16381 (expected the first 64 bits "
      "of a sensor's data sheet, the lowest byte first)");
  EXPECT_EQ(
      MessageOf(" D6 12", " D6"),
      "lab.yaml:13:14: error: basic = '2B C0 F2 66 30 87 D6' is not eight bytes (expected 16 hexadecimal "
      "digits, the lowest byte first)");
  EXPECT_EQ(MessageOf("basic: 2B", "basic: 2G").substr(0, 60),
            "lab.yaml:13:14: error: basic = '2G C0 F2 66 30 87 D6 12' is ");
  EXPECT_EQ(MessageOf("{\"%Sens@Ref\": 0.0102, ", "{"),
            "lab.yaml:15:7: error: %Sens@Ref is missing or 0, so that nothing can be scaled (expected the "
            "fields of the sensor's data sheet)");
  EXPECT_EQ(MessageOf("\"%Sign\": \"-\"", "\"%Sign\": up"),
            "lab.yaml:15:7: error: %Sign = 'up' is neither + nor - (expected the fields of the sensor's data "
            "sheet)");
  EXPECT_EQ(MessageOf("%CalDate", "%CalDat").substr(0, 44), "lab.yaml:15:51: error: unknown key '%CalDat'");
  EXPECT_EQ(MessageOf("serial: \"1234567\"", "serial: SN-9"),
            "lab.yaml:11:13: error: serial = SN-9 is another sensor than that of its data sheet (expected "
            "1234567)");
  EXPECT_EQ(MessageOf("    teds:", "    calibration: CAL-7\n    teds:"),
            "lab.yaml:12:18: error: calibration stands in the sensor's data sheet (expected teds, or "
            "calibration, not both)");
}

}  // namespace
}  // namespace strainwave::bench::teds_section_test
