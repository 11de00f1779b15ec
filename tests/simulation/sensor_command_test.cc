// SPDX-License-Identifier: Apache-2.0
// Campaigns whose sensors are checked, or whose calibrations have run out, as a user runs them.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <regex>

#include "bench/campaign/journal.h"
#include "bench/configuration/embedded_bench.h"
#include "daq/cycle_file.h"
#include "tests/checkout.h"
#include "tests/simulation/program.h"

namespace strainwave::sensor_command_test {
namespace {

const std::string kSchedule = SourceFolder() + "/tests/simulation/small.yaml";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  if (place == std::string::npos) throw std::logic_error("not in the text: " + from);
  return text.replace(place, from.size(), to);
}

std::string Written(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
  return file.string();
}

// Short cycles that begin with checks of the torque transducer and the encoders.
std::string ScheduleWithChecks(const std::string& zero_allowed) {
  const std::string text = Replaced(WholeFile(kSchedule), "duration: 20 min",
                                    "vibration_statistics: 12.8 kHz\n    duration: 1 min");
  return Replaced(text, "\nphases:\n",
                  "\nphases:\n  - {kind: zero_check, allowed: " + zero_allowed +
                      "}\n  - {kind: shunt_check, expected: 50 Nm, allowed: 0.3 Nm, "
                      "on_failure: mark}\n  - {kind: reference_check, allowed: 30 arcmin}\n");
}

std::string BenchWith(const std::string& plant) {
  return Replaced(bench::EmbeddedBenchText(), "plant: []", "plant:\n" + plant);
}

nlohmann::json CheckNamed(const nlohmann::json& document, const std::string& quantity) {
  for (const auto& check : document["sensor_checks"]) {
    if (check["quantity"] == quantity) return check;
  }
  ADD_FAILURE() << "no check " << quantity;
  return {};
}

// Truth: the transducer's zero creeps by 20 Nm a day, its gain is 1 % too high, and the output encoder is
// read 1 ms late; nothing else moves the zero.
TEST(SensorChecks, FindWhatIsWrongWithTheSensorsAndWhereItGoes) {
  const ScratchFolder scratch;
  const std::string text = BenchWith(
      "    - {term: torque_zero_drift, enabled: false}\n"
      "    - {term: torque_ageing, parameters: {zero_Nm_per_day: 20}}\n"
      "    - {term: torque_gain_error, parameters: {gain_error: 0.01, scatter: 0}}\n");
  const std::string schedule = Written(scratch / "schedule.yaml", ScheduleWithChecks("5 Nm"));
  const std::string bench =
      Written(scratch / "bench.yaml", Replaced(text, "time_skew: 0 s", "time_skew: 1 ms"));
  const std::string folder = (scratch / "campaign").string();
  const ProgramResult result = RunProgram({"run", schedule, "--bench", bench, "--out", folder});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const auto status = nlohmann::json::parse(RunProgram({"status", folder, "--json"}).out);
  const auto zero = CheckNamed(status, "zero_check_Nm");
  EXPECT_EQ(zero["checks"], 3);
  EXPECT_NEAR(zero["slope_per_day"].get<double>(), 20.0, 2.0);
  EXPECT_NEAR(zero["days_to_limit"].get<double>(), (5.0 - zero["value"].get<double>()) / 20.0, 0.05);
  EXPECT_EQ(zero["flag"], "");
  // The shunt's 50 Nm times the gain, and what the bent characteristic adds there: 0.02 (x - x^3) Nm, x =
  // 0.5.
  const auto shunt = CheckNamed(status, "shunt_check_Nm");
  EXPECT_NEAR(shunt["value"].get<double>(), 50.5 + 0.0075, 0.02);
  EXPECT_TRUE(shunt["flag"].get<std::string>().starts_with("shunt check: 50.5")) << shunt["flag"];
  EXPECT_NEAR(CheckNamed(status, "reference_check_arcmin")["value"].get<double>(),
              CheckNamed(status, "reference_check_arcmin")["expected"].get<double>(), 5.0);
  // The same from the raw records.
  const auto again = nlohmann::json::parse(RunProgram({"recompute", folder, "--json"}).out);
  EXPECT_EQ(again["cycles_equal_to_stored"], 4);
  EXPECT_EQ(CheckNamed(again, "zero_check_Nm"), zero);
  const auto& cycle = again["cycles"][0];
  EXPECT_NEAR(cycle["encoder_skew_us"].get<double>(), 1000.0, 10.0);
  EXPECT_LT(cycle["encoder_skew_us_se"].get<double>(), 10.0);
  // The load run turns as fast under the same torque as the rotation whose raw vibration is kept, but turns
  // back every two seconds.
  const double rms = cycle["load_run_vibration_rms_accel_x_m_per_s2"].get<double>();
  EXPECT_NEAR(rms / cycle["vibration_rms_accel_x_m_per_s2"].get<double>(), 0.9, 0.2);
  EXPECT_GT(cycle["load_run_vibration_crest_accel_x"].get<double>(), 1.0);
  EXPECT_GT(cycle["load_run_vibration_kurtosis_accel_x"].get<double>(), 1.0);
}

TEST(SensorChecks, StopTheCampaignAndAreNotPassedOver) {
  const ScratchFolder scratch;
  const std::string schedule = Written(scratch / "schedule.yaml", ScheduleWithChecks("0.5 Nm"));
  const std::string bench = Written(
      scratch / "bench.yaml", BenchWith("    - {term: torque_zero_offset, parameters: {offset_Nm: 1}}\n"));
  const std::string folder = (scratch / "campaign").string();
  EXPECT_EQ(RunProgram({"run", schedule, "--bench", bench, "--out", folder}).exit_code, 3);
  const auto alarm = nlohmann::json::parse(RunProgram({"status", folder, "--json"}).out)["alarms"][0];
  EXPECT_EQ(alarm["code"], "sensor_check");
  const std::regex words(
      "a sensor does not show what it should: zero check: [01]\\.[0-9]+ is further than 0.5 from 0 \\(in "
      "Nm\\); "
      "look for a torque that is locked in between the brakes and for a loose plug, then zero the amplifier "
      "or "
      "have the transducer calibrated");
  EXPECT_TRUE(std::regex_match(alarm["text"].get<std::string>(), words)) << alarm["text"];
  // The check is run again, not passed over.
  EXPECT_EQ(RunProgram({"run", schedule, "--bench", bench, "--out", folder, "--resume"}).exit_code, 3);
  const auto journal =
      bench::Journal::Open(std::filesystem::path(folder) / "campaign.db", bench::Database::Mode::kReadOnly);
  const auto phases = journal.Phases(1);
  ASSERT_EQ(phases.size(), 2u);
  EXPECT_EQ(phases[1].kind, "zero_check");
  EXPECT_EQ(phases[1].outcome, "fault");
}

TEST(ExpiredCalibration, BlocksTheStartOrStampsTheData) {
  const ScratchFolder scratch;
  const std::string schedule =
      Written(scratch / "schedule.yaml",
              Replaced(Replaced(WholeFile(kSchedule), "duration: 20 min", "duration: 1 min"), "cycles: 3",
                       "cycles: 1"));
  const std::string bench =
      Written(scratch / "bench.yaml", Replaced(bench::EmbeddedBenchText(), "calibration: SIM-CAL-TORQUE",
                                               "calibration: SIM-CAL-TORQUE\n  calibration_due: 2020-01-31"));
  const std::string folder = (scratch / "campaign").string();
  const auto today = std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
  const auto days = (today - std::chrono::sys_days(std::chrono::year(2020) / 1 / 31)).count();
  const std::string words = "calibration SIM-CAL-TORQUE of channel output_torque was due on 2020-01-31, " +
                            std::to_string(days) + " days ago (sensor SIM-TORQUE)";
  const ProgramResult blocked = RunProgram({"run", schedule, "--bench", bench, "--out", folder});
  EXPECT_EQ(blocked.exit_code, 2);
  EXPECT_EQ(
      blocked.error,
      bench + ":28:20: error: " + words +
          " (expected a calibration that holds today: have the sensor calibrated and write the new "
          "certificate into the bench file, or start with --accept-expired, and every record says so)\n");
  EXPECT_FALSE(std::filesystem::exists(folder));
  const ProgramResult stamped =
      RunProgram({"run", schedule, "--bench", bench, "--out", folder, "--accept-expired"});
  EXPECT_EQ(stamped.exit_code, 0) << stamped.error;
  const auto records = daq::ReadCycleFile(folder + "/cycles/000001.h5").records;
  const auto loop = std::ranges::find(records, "/hysteresis/hysteresis_1", &daq::NamedRecord::group);
  ASSERT_NE(loop, records.end());
  EXPECT_EQ(loop->record.FindColumn("torque_Nm")->calibration, "SIM-CAL-TORQUE; not valid: " + words);
  EXPECT_EQ(loop->record.FindColumn("output_angle_deg")->calibration, "SIM-CAL-OUTPUT");
}

}  // namespace
}  // namespace strainwave::sensor_command_test
