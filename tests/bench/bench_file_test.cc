// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "bench/configuration/check_schedule.h"
#include "bench/configuration/embedded_bench.h"
#include "bench/configuration/read_bench_file.h"
#include "schedules/reader/read_schedule.h"
#include "tests/bench/bench_message.h"
#include "tests/checkout.h"
#include "tests/schedules/schedule_text.h"

namespace strainwave::bench::bench_file_test {
namespace {

using schedules::GoodSchedule;
using schedules::With;

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-12;  // relative to values below 1000

std::string GoodBench() {
  return R"(bench: 1
name: small
simulated: true
driving_servo: {peak_torque: 7 Nm, peak_speed: 3000 rpm, max_acceleration: 2000 rad/s2}
load_servo: {peak_torque: 7 Nm, peak_speed: 6000 rpm, max_acceleration: 2000 rad/s2}
torque_transducer:
  range: 100 Nm
input_encoder: {counts_per_rev: 1048576, accuracy: 20 arcsec}
output_encoder: {counts_per_rev: 268435456, accuracy: 2.5 arcsec, sign: -1}
accelerometers:
  - name: accel_x
simulation:
  seed: 7
  plant:
    - term: kinematic_error
      parameters: {first_rad: 1e-5, second_rad: 2.5e-4}
    - term: creep
      enabled: false
)";
}

std::string BenchMessageOf(const std::string& text) {
  return bench::BenchMessageOf(text, "small-bench.yaml");
}

// What the bench says to the small schedule with one change.
std::string Check(std::string_view from, std::string_view to, const std::string& bench_text = GoodBench()) {
  const schedules::Schedule schedule = schedules::ParseSchedule(With(GoodSchedule(), from, to), "small.yaml");
  std::string lines;
  for (const auto& finding :
       CheckScheduleAgainstBench(schedule, ParseBenchFile(bench_text, "small-bench.yaml")).items()) {
    if (!lines.empty()) lines += '\n';
    lines += FormatFinding("small.yaml", finding);
  }
  return lines;
}

// What comes before all else where the bench has no accelerometers.
const std::string kNoLimit =
    "small.yaml:21:18: warning: vibration_rms = 50 m/s2 watches nothing: small-bench.yaml has no "
    "accelerometers "
    "(expected one)\n";

TEST(BenchFile, ReadsEveryValueInSi) {
  const BenchDescription bench = ParseBenchFile(GoodBench(), "small-bench.yaml");
  EXPECT_EQ(bench.name, "small");
  EXPECT_TRUE(bench.simulated);
  EXPECT_NEAR(bench.driving_servo.peak_speed_rad_per_s, 100.0 * kPi, kRounding * 1000.0);
  EXPECT_EQ(bench.load_servo.peak_torque_Nm, 7.0);
  EXPECT_EQ(bench.transducer.range_Nm, 100.0);
  EXPECT_EQ(bench.input_encoder.counts_per_rev, 1 << 20);
  EXPECT_EQ(bench.input_encoder.sign, 1);
  EXPECT_EQ(bench.output_encoder.sign, -1);
  EXPECT_NEAR(bench.output_encoder.accuracy_rad, 2.5 * kPi / 648000.0, kRounding);
}

TEST(BenchFile, FillsInDefaults) {
  const BenchDescription bench = ParseBenchFile(GoodBench(), "small-bench.yaml");
  EXPECT_EQ(bench.control_period_s, 0.01);
  EXPECT_EQ(bench.load_reducer_ratio, 70.0);
  EXPECT_EQ(bench.vibration_rate_hz, 51200.0);
  EXPECT_EQ(bench.transducer.relative_linearity, 0.003);
  EXPECT_EQ(bench.transducer.relative_gain_uncertainty, 0.0005);
  ASSERT_EQ(bench.accelerometers.size(), 1U);
  EXPECT_NEAR(bench.accelerometers[0].sensitivity_V_per_m_per_s2, 0.1 / 9.80665, kRounding);
  EXPECT_FALSE(bench.simulation.write_truth);
  EXPECT_EQ(bench.simulation.time_skew_s, 0.0);
}

TEST(BenchFile, KeepsTheTermsOfThePlantInTheirOrder) {
  const SimulationDescription simulation = ParseBenchFile(GoodBench(), "small-bench.yaml").simulation;
  EXPECT_EQ(simulation.seed, 7U);
  ASSERT_EQ(simulation.terms.size(), 2U);
  EXPECT_EQ(simulation.terms[0].name, "kinematic_error");
  EXPECT_TRUE(simulation.terms[0].enabled);
  EXPECT_EQ(simulation.terms[0].line, 15);
  const std::vector<std::pair<std::string, double>> expected{{"first_rad", 1e-5}, {"second_rad", 2.5e-4}};
  EXPECT_EQ(simulation.terms[0].parameters, expected);
  EXPECT_FALSE(simulation.terms[1].enabled);
}

TEST(BenchFile, ReadsAPlantFileBesideItself) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "strainwave_bench_file_test";
  std::filesystem::create_directories(folder);
  const std::string inline_terms = GoodBench().substr(GoodBench().find("  plant:"));
  { std::ofstream(folder / "bench.yaml") << With(GoodBench(), inline_terms, "  plant_file: plant.yaml\n"); }
  {
    std::ofstream(folder / "plant.yaml")
        << "plant: 1\nterms:\n  - term: creep\n    parameters: {share: 0.01}\n";
  }
  const BenchDescription bench = ReadBenchFile(folder / "bench.yaml");
  ASSERT_EQ(bench.simulation.terms.size(), 1U);
  EXPECT_EQ(bench.simulation.terms[0].name, "creep");
  EXPECT_EQ(bench.simulation.plant_file, "plant.yaml");

  {
    std::ofstream(folder / "plant.yaml")
        << "plant: 1\nterms:\n  - term: creep\n    parameters: {share: 1 %}\n";
  }
  std::string message;
  try {
    ReadBenchFile(folder / "bench.yaml");
  } catch (const BenchFileError& error) {
    message = error.what();
  }
  EXPECT_EQ(message, (folder / "bench.yaml").string() +
                         ":14:15: error: plant_file cannot be used (expected a plant file):\n" +
                         (folder / "plant.yaml").string() +
                         ":4:25: error: share = 1 %: '%' after the number (expected a plain number)");
  std::filesystem::remove_all(folder);
}

TEST(BenchFile, ReportsAllErrorsAtOnce) {
  std::string text = GoodBench();
  text = With(text, "simulated: true", "simulated: maybe");
  text = With(text, "range: 100 Nm", "range: 100 rpm\n  calibration_due: 2026-02-30");
  text = With(text, "sign: -1", "sign: 2");
  text = With(text, "- name: accel_x", "- name: accel_x\n  - name: accel_x");
  text = With(text, "seed: 7", "sead: 7");
  text = With(text, "term: creep", "term: kinematic_error");
  EXPECT_EQ(
      BenchMessageOf(text),
      "small-bench.yaml:3:12: error: simulated = maybe: not known (expected true or false)\n"
      "small-bench.yaml:7:10: error: range = 100 rpm: 'rpm' is not a unit of torque (expected Nm, mNm, Ncm "
      "or "
      "kNm)\n"
      "small-bench.yaml:8:20: error: calibration_due = 2026-02-30 is not a date (expected YYYY-MM-DD)\n"
      "small-bench.yaml:10:73: error: sign = 2: not known (expected 1 or -1)\n"
      "small-bench.yaml:13:11: error: two accelerometers are named 'accel_x' (expected a name of its own)\n"
      "small-bench.yaml:15:3: error: unknown key 'sead', did you mean 'seed'? (expected seed, time_skew, "
      "write_truth, plant, plant_file)\n"
      "small-bench.yaml:19:13: error: term 'kinematic_error' is there twice (expected once; it is already on "
      "line 17)");
}

TEST(BenchFile, KnowsWhichDaysExist) {
  const auto message = [](const std::string& date) {
    return BenchMessageOf(With(GoodBench(), "range: 100 Nm", "range: 100 Nm\n  calibration_due: " + date));
  };
  for (const char* date : {"2027-01-31", "2028-02-29", "2000-02-29"}) EXPECT_EQ(message(date), "") << date;
  for (const char* date : {"2027-02-29", "2028-02-30", "2100-02-29", "2027-04-31", "2027-13-01", "2027-00-01",
                           "2027-01-00", "27-01-01", "01.02.2027", "2027-1-1", "2027-01-1x"}) {
    EXPECT_EQ(message(date), "small-bench.yaml:8:20: error: calibration_due = " + std::string(date) +
                                 " is not a date (expected YYYY-MM-DD)");
  }
}

TEST(BenchFile, RefusesASimulationOfARealBench) {
  EXPECT_EQ(
      BenchMessageOf(With(GoodBench(), "simulated: true", "simulated: false")),
      "small-bench.yaml:12:1: error: simulation belongs to a simulated bench (expected 'simulated: true')");
}

TEST(BenchFile, SaysThatAScheduleIsNotABench) {
  EXPECT_EQ(BenchMessageOf("").substr(0, 79),
            "small-bench.yaml:1:1: error: the file is empty (expected a bench that begins wi");
  EXPECT_NE(BenchMessageOf(GoodSchedule()).find("small-bench.yaml:1:1: error: unknown key 'schedule'"),
            std::string::npos);
}

TEST(EmbeddedBench, IsABenchFileLikeAnyOther) {
  const BenchDescription bench = EmbeddedBench();
  EXPECT_TRUE(bench.simulated);
  EXPECT_EQ(bench.accelerometers.size(), 4U);
  EXPECT_EQ(bench.control_period_s, 0.01);
}

TEST(EmbeddedBench, RunsEveryScheduleThatComesWithTheProgram) {
  const std::filesystem::path folder = std::filesystem::path(SourceFolder()) / "schedules";
  ASSERT_TRUE(std::filesystem::exists(folder / "quick.yaml"));
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    const schedules::Schedule schedule = schedules::ReadSchedule(entry.path());
    for (const auto& finding : CheckScheduleAgainstBench(schedule, EmbeddedBench()).items()) {
      ADD_FAILURE() << FormatFinding(entry.path().string(), finding);
    }
  }
}

TEST(CheckScheduleAgainstBench, TakesAScheduleWithinTheBench) {
  EXPECT_EQ(Check("cycles: 3", "cycles: 3"), "");
}

TEST(CheckScheduleAgainstBench, NamesATorqueBeyondTheTransducer) {
  const std::string text = With(GoodSchedule(), "output_torque: 60 Nm", "output_torque: 130 Nm");
  const auto findings = CheckScheduleAgainstBench(
      schedules::ParseSchedule(With(text, "output_torque: 40 Nm", "output_torque: 120 Nm"), "small.yaml"),
      ParseBenchFile(GoodBench(), "small-bench.yaml"));
  ASSERT_EQ(findings.items().size(), 2U);
  EXPECT_EQ(FormatFinding("small.yaml", findings.items()[0]),
            "small.yaml:18:18: error: output_torque = 130 Nm is above the torque transducer's range = 100 Nm "
            "(small-bench.yaml, line 7)");
  EXPECT_EQ(FormatFinding("small.yaml", findings.items()[1]),
            "small.yaml:27:20: error: output_torque = 120 Nm is above the torque transducer's range = 100 Nm "
            "(small-bench.yaml, line 7)");
}

TEST(CheckScheduleAgainstBench, NamesASpeedBeyondTheDrive) {
  EXPECT_EQ(
      Check("input_speed: 2400 rpm", "input_speed: 2500 rpm",
            With(GoodBench(), "peak_speed: 3000 rpm", "peak_speed: 2450 rpm")),
      "small.yaml:19:16: error: input_speed = 3000 rpm is above the driving servo's peak_speed = 2450 rpm "
      "(small-bench.yaml, line 4)\n"
      "small.yaml:28:18: error: input_speed = 2500 rpm is above the driving servo's peak_speed = 2450 rpm "
      "(small-bench.yaml, line 4)");
}

TEST(CheckScheduleAgainstBench, NamesWhatADriveOnModbusCannotDo) {
  const std::string file = SourceFolder() + "/tests/simulation/field/modbus.yaml";
  const BenchDescription bench = ReadBenchFile(file);
  std::string lines;
  for (const auto& finding :
       CheckScheduleAgainstBench(schedules::ParseSchedule(GoodSchedule(), "small.yaml"), bench).items()) {
    lines += FormatFinding("small.yaml", finding) + '\n';
  }
  const std::string why =
      " moves the input from position to position, which a drive on Modbus does not (expected a driving "
      "servo "
      "on CANopen in " +
      file + ")\n";
  EXPECT_EQ(lines, "small.yaml:29:11: error: kind = hysteresis" + why +
                       "small.yaml:31:11: error: kind = transmission_error" + why);
}

TEST(CheckScheduleAgainstBench, NamesASpeedAtWhichTheDriveCannotBeLedFromPositionToPosition) {
  const BenchDescription bench = ReadBenchFile(SourceFolder() + "/bench/examples/in_process.yaml");
  const auto check = [&](std::string_view speed) {
    const std::string text = With(GoodSchedule(), "input_speed: 300 rpm", speed);
    std::string lines;
    for (const auto& finding :
         CheckScheduleAgainstBench(schedules::ParseSchedule(text, "small.yaml"), bench).items()) {
      lines += FormatFinding("small.yaml", finding);
    }
    return lines;
  };
  EXPECT_EQ(check("input_speed: 1400 rpm"), "");
  // 270 deg in 10 ms, 4 ms and 17 ms.
  EXPECT_EQ(
      check("input_speed: 1500 rpm"),
      "small.yaml:32:18: error: input_speed = 1500 rpm is above the 1452 rpm at which the driving servo "
      "lags by the 270 deg of its following_error_window within control_period, sync_period and "
      "position_loop_lag (" +
          bench.file_name + ")");
}

TEST(CheckScheduleAgainstBench, NamesATorqueBeyondTheServos) {
  EXPECT_EQ(Check("cycles: 3", "cycles: 3",
                  With(GoodBench(), "load_servo: {peak_torque: 7", "load_servo: {peak_torque: 0.5")),
            "small.yaml:27:20: error: output_torque = 40 Nm is above the 35 Nm of the load servo behind its "
            "reducer "
            "(small-bench.yaml)");
  EXPECT_EQ(Check("cycles: 3", "cycles: 3",
                  With(GoodBench(), "driving_servo: {peak_torque: 7", "driving_servo: {peak_torque: 0.4")),
            "small.yaml:27:20: error: output_torque = 40 Nm is above the 32 Nm of the driving servo behind "
            "the gear "
            "(small-bench.yaml)");
}

// The bench of metal whose drives' profiles allow less than its file says of the servos.
TEST(CheckScheduleAgainstBench, NamesWhatTheProfilesOfTheDrivesDoNotAllow) {
  const auto check = [](bool weak_is_load, const std::string& from, const std::string& to) {
    const std::filesystem::path profiles = SourceFolder() + "/bench/devices/profiles";
    std::ifstream shipped(profiles / "strainwave_drive.yaml");
    const std::string profile = With({std::istreambuf_iterator<char>(shipped), {}}, from, to);
    const auto folder = std::filesystem::path(testing::TempDir()) / "weak_drive";
    std::filesystem::create_directories(folder);
    std::filesystem::copy_file(profiles / "strainwave_drive.eds", folder / "strainwave_drive.eds",
                               std::filesystem::copy_options::overwrite_existing);
    std::ofstream(folder / "weak.yaml") << profile;
    BenchDescription bench = ReadBenchFile(SourceFolder() + "/bench/examples/in_process.yaml");
    (weak_is_load ? bench.load_servo : bench.driving_servo).drive.profile = folder / "weak.yaml";
    bench.file_name = "bench.yaml";
    std::string lines;
    for (const auto& finding :
         CheckScheduleAgainstBench(schedules::ParseSchedule(GoodSchedule(), "small.yaml"), bench).items()) {
      lines += FormatFinding("small.yaml", finding) + "\n";
    }
    return lines;
  };
  EXPECT_EQ(check(true, "  torque: 7.16 Nm", "  torque: 0.5 Nm"),
            "small.yaml:27:20: error: output_torque = 40 Nm is above the 35 Nm behind its reducer that the "
            "profile of the load servo's drive allows (bench.yaml)\n");
  EXPECT_EQ(
      check(false, "  torque: 7.16 Nm", "  torque: 0.4 Nm"),
      "small.yaml:27:20: error: output_torque = 40 Nm is above the 32 Nm behind the gear that the profile "
      "of the driving servo's drive allows (bench.yaml)\n");
  EXPECT_EQ(check(false, "  speed: 6000 rpm", "  speed: 600 rpm"),
            "small.yaml:28:18: error: input_speed = 2400 rpm is above the 600 rpm that the profile of the "
            "driving servo's drive allows (bench.yaml)\n");
  EXPECT_EQ(
      check(true, "  speed: 6000 rpm", "  speed: 1400 rpm"),
      "small.yaml:28:18: error: input_speed = 2400 rpm is above the 1600 rpm that the profile of the load "
      "servo's drive lets it follow behind its reducer (bench.yaml)\n");
}

TEST(CheckScheduleAgainstBench, NamesASpeedThatTheLoadCannotFollow) {
  EXPECT_EQ(
      Check("cycles: 3", "cycles: 3", With(GoodBench(), "peak_speed: 6000 rpm", "peak_speed: 1750 rpm")),
      "small.yaml:28:18: error: input_speed = 2400 rpm is above the 2000 rpm at which the load servo behind "
      "its "
      "reducer can follow (small-bench.yaml)");
}

TEST(CheckScheduleAgainstBench, NamesAnAccelerationBeyondTheDrive) {
  EXPECT_EQ(Check("input_speed: 2400 rpm", "input_speed: 2400 rpm\n    input_acceleration: 2500 rad/s2"),
            "small.yaml:29:25: error: input_acceleration = 2500 rad/s2 is above the driving servo's "
            "max_acceleration "
            "= 2000 rad/s2 (small-bench.yaml, line 4)");
}

// From 40 to 60 Nm at 2100 Nm/s it takes 9.52 ms, from 2920 to 3000 rpm at 1000 rad/s² 8.38 ms.
TEST(CheckScheduleAgainstBench, NamesARampThatPassesALimitBetweenTwoLooks) {
  EXPECT_EQ(Check("output_torque: 40 Nm", "output_torque: 40 Nm\n    torque_rate: 1900 Nm/s"), "");
  EXPECT_EQ(Check("output_torque: 40 Nm", "output_torque: 40 Nm\n    torque_rate: 2100 Nm/s"),
            "small.yaml:27:20: error: output_torque = 40 Nm, rising by torque_rate = 2100 Nm/s, may pass "
            "limits.output_torque = 60 Nm between two looks of the bench, a control_period = 10 ms apart "
            "(expected at most 9.52 ms, small-bench.yaml)");
  EXPECT_EQ(
      Check("input_speed: 2400 rpm", "input_speed: 2920 rpm\n    input_acceleration: 1000 rad/s2"),
      "small.yaml:28:18: error: input_speed = 2920 rpm, rising by input_acceleration = 1000 rad/s2, may "
      "pass limits.input_speed = 3000 rpm between two looks of the bench, a control_period = 10 ms apart "
      "(expected at most 8.38 ms, small-bench.yaml)");
}

TEST(CheckScheduleAgainstBench, NamesRatesBeyondWhatIsSampled) {
  EXPECT_EQ(
      Check("input_speed: 2400 rpm", "input_speed: 2400 rpm\n    log_rate: 101 Hz"),
      "small.yaml:29:15: error: log_rate = 101 Hz is above the 100 Hz at which the bench reads its channels "
      "(small-bench.yaml)");
  EXPECT_EQ(Check("phases:\n",
                  "phases:\n  - {kind: measurement_rotation, input_speed: 300 rpm, output_torque: 0 Nm, "
                  "vibration_rate: 60 kHz}\n"),
            "small.yaml:25:93: error: vibration_rate = 60 kHz is above the bench's vibration_rate = 51.2 kHz "
            "(small-bench.yaml)");
  EXPECT_EQ(Check("input_speed: 300 rpm", "input_speed: 300 rpm\n    averaging: 5 ms"),
            "small.yaml:33:16: error: averaging = 5 ms is below the bench's control_period = 10 ms "
            "(small-bench.yaml)");
}

TEST(CheckScheduleAgainstBench, SaysThatALimitOfVibrationWatchesNothingWithoutAccelerometers) {
  EXPECT_EQ(Check("cycles: 3", "cycles: 3", With(GoodBench(), "accelerometers:\n  - name: accel_x\n", "")),
            "small.yaml:21:18: warning: vibration_rms = 50 m/s2 watches nothing: small-bench.yaml has no "
            "accelerometers "
            "(expected one)");
}

TEST(CheckScheduleAgainstBench, NamesALimitOfVibrationThatAnAccelerometerCannotShow) {
  EXPECT_EQ(
      Check("cycles: 3", "cycles: 3", With(GoodBench(), "name: accel_x", "name: accel_x\n    range: 4 g")),
      "small.yaml:21:18: error: vibration_rms = 50 m/s2 is above the range of accel_x = 4 g "
      "(small-bench.yaml, "
      "line 12)");
}

TEST(CheckScheduleAgainstBench, WantsAccelerometersForTheRotation) {
  EXPECT_EQ(Check("duration: 30 min", "duration: 30 min\n    vibration_statistics: 12.8 kHz",
                  With(GoodBench(), "accelerometers:\n  - name: accel_x\n", "")),
            kNoLimit +
                "small.yaml:27:27: error: vibration_statistics needs vibration, but small-bench.yaml has no "
                "accelerometers (expected at least one)");
  EXPECT_EQ(
      Check("phases:\n",
            "phases:\n  - {kind: measurement_rotation, input_speed: 300 rpm, output_torque: 0 Nm}\n",
            With(GoodBench(), "accelerometers:\n  - name: accel_x\n", "")),
      kNoLimit +
          "small.yaml:25:12: error: kind = measurement_rotation needs vibration, but small-bench.yaml has no "
          "accelerometers (expected at least one)");
}

}  // namespace
}  // namespace strainwave::bench::bench_file_test
