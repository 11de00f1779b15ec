// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/campaign/acquisition_results.h"
#include "bench/campaign/calibrations.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/check_results.h"
#include "bench/campaign/check_trends.h"
#include "bench/campaign/cycle_results.h"
#include "bench/campaign/cycle_steps.h"
#include "bench/campaign/record_results.h"
#include "bench/campaign/time_to_go.h"
#include "bench/errors/bench_error.h"
#include "bench/utc.h"
#include "daq/acquisition/running_statistics.h"

namespace strainwave::bench::campaign_parts_test {
namespace {

TEST(Sha256, IsThatOfTheStandard) {
  // FIPS 180-4, example of one block.
  EXPECT_EQ(Sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Difference, NamesTheLinesThatDiffer) {
  EXPECT_EQ(Difference("a\nb\nc\n", "a\nB\nc\n"), "  line 2: -b\n  line 2: +B\n");
  EXPECT_EQ(Difference("a\nb\n", "a\nx\nb\n"), "  line 2: +x\n");
  EXPECT_EQ(Difference("same\n", "same\n"), "");
}

TEST(UtcText, IsReadable) { EXPECT_EQ(UtcText(1772366400250), "2026-03-01T12:00:00.250Z"); }

schedules::Schedule LoadAndLock() {
  schedules::Schedule schedule;
  schedule.cycles = 2;
  schedule.measurements.repeatability_repeats = 2;
  schedule.preparation.push_back({"blank", schedules::BlankTest{10.0, 1.0, 36}, 1});
  schedules::LoadRun run;
  run.duration_s = 60.0;
  run.input_speed_rad_per_s = 100.0;
  run.input_acceleration_rad_per_s2 = 100.0;
  run.torque_rate_Nm_per_s = 10.0;
  schedule.phases.push_back({"load", run, 2});
  schedules::HysteresisTest lock;
  lock.peak_torque_Nm = 34.0;
  lock.torque_rate_Nm_per_s = 3.0;
  lock.lock_angles_rad = {0.0};
  schedule.phases.push_back({"lock", lock, 3});
  return schedule;
}

TEST(StepsOf, PutsTheRepeatsAfterThePreparation) {
  const schedules::Schedule schedule = LoadAndLock();
  const auto preparation = StepsOf(schedule, 0);
  ASSERT_EQ(preparation.size(), 3u);
  EXPECT_EQ(preparation[0].group, "blank");
  EXPECT_EQ(preparation[1].group, "repeat_1/lock");
  EXPECT_EQ(preparation[2].group, "repeat_2/lock");
  const auto cycle = StepsOf(schedule, 1);
  ASSERT_EQ(cycle.size(), 2u);
  EXPECT_TRUE(cycle[0].accumulates);
  EXPECT_FALSE(cycle[0].measurement);
  EXPECT_TRUE(cycle[1].measurement);
  EXPECT_EQ(cycle[1].begins_s, cycle[0].planned_s);
}

TEST(TimeToGo, IsThatOfThePlanWithoutWhatIsDone) {
  const schedules::Schedule schedule = LoadAndLock();
  const double preparation_s = PlannedDuration_s(StepsOf(schedule, 0));
  const double cycle_s = PlannedDuration_s(StepsOf(schedule, 1));
  EXPECT_DOUBLE_EQ(TimeToGo_s(schedule, 0, {}, 0.0, 0.0), preparation_s + 2.0 * cycle_s);
  const double load_s = StepsOf(schedule, 1)[0].planned_s;
  const auto row = [](int step, const char* outcome) {
    PhaseRow phase;
    phase.cycle = 1;
    phase.step = step;
    phase.started_s = 1000.0;
    phase.outcome = outcome;
    return phase;
  };
  const auto to_go_s = [&](const PhaseRow& newest, double credited_s, double bench_time_s) {
    return TimeToGo_s(schedule, 1, std::vector{newest}, credited_s, bench_time_s);
  };
  // Half of the load, and for as long as that may have taken.
  EXPECT_DOUBLE_EQ(to_go_s(row(0, "running"), 30.0, 5000.0), 2.0 * cycle_s - 0.5 * load_s);
  EXPECT_DOUBLE_EQ(to_go_s(row(0, "interrupted"), 30.0, 5000.0), 2.0 * cycle_s - 0.5 * load_s);
  EXPECT_DOUBLE_EQ(to_go_s(row(0, "complete"), 60.0, 5000.0), 2.0 * cycle_s - load_s);
  EXPECT_DOUBLE_EQ(to_go_s(row(1, "running"), 0.0, 1002.0), 2.0 * cycle_s - load_s - 2.0);
  EXPECT_DOUBLE_EQ(to_go_s(row(1, "suspended"), 0.0, 1002.0), 2.0 * cycle_s - load_s) << "it begins anew";
  EXPECT_DOUBLE_EQ(to_go_s(row(1, "running"), 0.0, 9000.0), cycle_s) << "no less than the cycles after it";
  EXPECT_EQ(TimeToGo_s(schedule, 3, {}, 0.0, 9000.0), 0.0);
}

// Two points a step apart, so that mean and range can be told by head.
NamedRecord Sweep(const std::string& group, double error_deg) {
  NamedRecord named{group, {}};
  named.record.kind = daq::RecordKind::kTransmissionError;
  std::vector<double> input, output, temperature;
  std::vector<daq::Direction> direction;
  for (int i = 0; i <= 72; ++i) {
    input.push_back(80.0 * 5.0 * i);
    output.push_back(5.0 * i - (i % 2 == 0 ? 0.0 : error_deg));
    temperature.push_back(40.0);
    direction.push_back(daq::Direction::kClockwise);
  }
  named.record.columns = {{"input_angle_deg", input, "", ""},
                          {"output_angle_deg", output, "", ""},
                          {"temperature_degC", temperature, "", ""},
                          {"direction", direction, "", ""}};
  return named;
}

CycleContext Context() {
  CycleContext context;
  context.ratio = 80.0;
  context.declared_temperature_degC = 40.0;
  context.temperature_tolerance_K = 5.0;
  return context;
}

TEST(AnalyzeCycle, CountsOnlyTheLastOfRepeatedMeasurements) {
  const std::vector<NamedRecord> records{Sweep("te/transmission_error", 0.02),
                                         Sweep("te/retry_1/transmission_error", 0.01)};
  const auto analysis = AnalyzeCycle(records, Context());
  EXPECT_NEAR(FindResult(analysis.results, "e_max_arcmin")->value, 0.6, 1e-6);
  EXPECT_NEAR(FindResult(analysis.results, "e_avg_arcmin")->value, 0.3, 1e-6);
}

TEST(AnalyzeCycle, FlagsWhatWasNotMeasuredInTheDeclaredThermalState) {
  CycleContext context = Context();
  const std::vector<NamedRecord> records{Sweep("te/transmission_error", 0.01)};
  EXPECT_EQ(FindResult(AnalyzeCycle(records, context).results, "e_max_arcmin")->flag, "");
  context.declared_temperature_degC = 30.0;
  EXPECT_EQ(FindResult(AnalyzeCycle(records, context).results, "e_max_arcmin")->flag,
            "measured at 40.0 degC, declared are 30.0 ± 5.0 degC");
}

TEST(AnalyzeCycle, TakesTheEncodersOwnErrorOff) {
  NamedRecord named = Sweep("te/transmission_error", 0.0);
  auto& output = std::get<std::vector<double>>(named.record.columns[1].values);
  for (double& angle_deg : output) angle_deg += 0.02 * std::sin(RadFromDeg(angle_deg));
  CycleContext context = Context();
  const std::vector<NamedRecord> records{named};
  EXPECT_NEAR(FindResult(AnalyzeCycle(records, context).results, "e_max_arcmin")->value, 2.4, 0.01);
  context.corrections.encoder.harmonics = {{1, 0.0, RadFromDeg(0.02)}};
  EXPECT_NEAR(FindResult(AnalyzeCycle(records, context).results, "e_max_arcmin")->value, 0.0, 0.002);
}

TEST(BenchUncertainty, AddsInQuadratureWhatAllLoopsShare) {
  BenchCorrections corrections;
  corrections.torque_gain_relative_se = 0.001;                                  // 25 of 25000
  corrections.series_compliance.compliance_rad_per_Nm = {5e-5, 60.0 / 6.25e8};  // 60 at 25000
  corrections.repeatability["k2_Nm_per_rad"] = 156.0;
  const auto k2 = WithBenchUncertainty({25000.0, 0.0}, "k2_Nm_per_rad", corrections);
  EXPECT_NEAR(k2.standard_error, std::sqrt(25.0 * 25.0 + 60.0 * 60.0 + 156.0 * 156.0), 1e-6);
  EXPECT_NEAR(WithBenchUncertainty({25000.0, 7.0}, "other", {}).standard_error, 7.0, 1e-12);
}

NamedRecord Check(const std::string& kind, const std::string& unit, double allowed,
                  std::vector<std::pair<std::string, std::vector<double>>> columns) {
  NamedRecord named{"the_check/check", {}};
  named.record.kind = daq::RecordKind::kHistory;
  named.record.SetMetadata("check", kind);
  if (unit == "Nm") named.record.SetMetadata("expected_Nm", kind == "shunt_check" ? 50.0 : 0.0);
  named.record.SetMetadata("allowed_" + unit, allowed);
  named.record.SetMetadata("most_noise_" + unit, 0.5);
  named.record.SetMetadata("ratio", 80.0);
  for (auto& [name, values] : columns) named.record.columns.push_back({name, std::move(values), {}, {}});
  return named;
}

TEST(SensorCheck, IsTheMeanWithoutTorque) {
  const auto results = SensorCheckResults(std::vector{
      Check("zero_check", "Nm", 0.2, {{"shunt", {0, 0, 0, 0}}, {"torque_Nm", {0.1, 0.2, 0.1, 0.2}}})});
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].quantity, "the_check_Nm");
  EXPECT_NEAR(results[0].value, 0.15, 1e-12);
  // Of four values 0.05 from their mean: s = sqrt(4 * 0.05^2 / 3), by the root of four.
  EXPECT_NEAR(results[0].standard_error, std::sqrt(0.01 / 3.0) / 2.0, 1e-12);
  EXPECT_EQ(results[0].flag, "");
}

TEST(SensorCheck, OfAShuntIsWhatItAddsToTheZero) {
  const auto record =
      Check("shunt_check", "Nm", 0.2, {{"shunt", {0, 0, 1, 1}}, {"torque_Nm", {1.9, 2.1, 52.5, 52.7}}});
  const Result result = SensorCheckResult(record.record, "the_check");
  EXPECT_NEAR(result.value, 50.6, 1e-12);
  EXPECT_EQ(result.flag, "shunt check: 50.6 is further than 0.2 from 50 (in Nm)");
}

TEST(SensorCheck, OfTheEncodersIsHeldAgainstTheFirst) {
  // 8 degrees at the input are 6 arcmin at the output.
  auto record = Check("reference_check", "arcmin", 5.0,
                      {{"input_angle_deg", {8.0, 8.0}}, {"output_angle_deg", {1.0, 1.0}}});
  EXPECT_NEAR(SensorCheckResult(record.record, "reference").value, 6.0 - 60.0, 1e-9);
  EXPECT_EQ(SensorCheckResult(record.record, "reference").quantity, "reference_arcmin");
  EXPECT_EQ(SensorCheckResult(record.record, "reference").flag, "") << "the first one";
  SetExpected(record.record, -48.0);
  EXPECT_EQ(SensorCheckResult(record.record, "reference").flag,
            "reference check: -54 is further than 5 from -48 (in arcmin)");
}

TEST(CheckHistories, TellWhenALimitIsMet) {
  schedules::Schedule schedule;
  schedules::SensorCheck check;
  check.allowed = 1.0;
  schedule.phases.push_back({"zero_check", check, 1});
  std::vector<TimedResults> cycles;
  for (int day = 0; day < 5; ++day) {
    const double scatter = day % 2 == 0 ? 1e-3 : -1e-3;
    cycles.push_back({static_cast<double>(day), {{"zero_check_Nm", 0.1 * day + scatter, 0.0, ""}}});
  }
  const auto histories = CheckHistories(schedule, cycles);
  ASSERT_EQ(histories.size(), 1u);
  EXPECT_EQ(histories[0].quantity, "zero_check_Nm");
  EXPECT_EQ(histories[0].checks, 5u);
  ASSERT_TRUE(histories[0].trend && histories[0].trend->days_left);
  EXPECT_NEAR(histories[0].trend->slope_per_day, 0.1, 1e-3);
  EXPECT_NEAR(*histories[0].trend->days_left, 6.0, 0.1) << "from 0.4 to 1 Nm at 0.1 Nm a day";
}

TEST(VibrationStatistics, OfPiecesAreThoseOfTheWhole) {
  const std::vector<double> all{1.0, -2.0, 4.0, 0.5, 3.0, -1.5, 2.5, 8.0};
  daq::acquisition::RunningStatistics first;
  daq::acquisition::RunningStatistics second;
  for (std::size_t i = 0; i < all.size(); ++i) (i < 3 ? first : second).Add(all[i]);
  std::vector<NamedRecord> records;
  for (const auto& piece : {first, second}) {
    const auto moments = piece.moments();
    NamedRecord named{records.empty() ? "load/vibration_statistics" : "load/vibration_statistics_2", {}};
    named.record.kind = daq::RecordKind::kHistory;
    named.record.SetMetadata("statistics", "vibration");
    for (const auto& [name, value] :
         {std::pair{"count", moments.count}, std::pair{"mean_m_per_s2", moments.mean},
          std::pair{"second_moment_m2_per_s4", moments.second},
          std::pair{"third_moment_m3_per_s6", moments.third},
          std::pair{"fourth_moment_m4_per_s8", moments.fourth}, std::pair{"least_m_per_s2", moments.least},
          std::pair{"most_m_per_s2", moments.most}}) {
      named.record.columns.push_back({std::string("accel_y_") + name, std::vector<double>{value}, {}, {}});
    }
    records.push_back(std::move(named));
  }
  // By the definitions, in two passes.
  double mean = 0.0;
  for (const double value : all) mean += value / 8.0;
  double second_moment = 0.0;
  double fourth_moment = 0.0;
  for (const double value : all) {
    second_moment += std::pow(value - mean, 2.0) / 8.0;
    fourth_moment += std::pow(value - mean, 4.0) / 8.0;
  }
  const auto results = VibrationStatisticsResults(records);
  ASSERT_EQ(results.size(), 4u);
  const auto value = [&](const char* quantity) { return FindResult(results, quantity)->value; };
  EXPECT_NEAR(value("load_vibration_rms_accel_y_m_per_s2"), std::sqrt(second_moment), 1e-12);
  EXPECT_NEAR(value("load_vibration_peak_accel_y_m_per_s2"), 8.0 - mean, 1e-12);
  EXPECT_NEAR(value("load_vibration_crest_accel_y"), (8.0 - mean) / std::sqrt(second_moment), 1e-12);
  EXPECT_NEAR(value("load_vibration_kurtosis_accel_y"), fourth_moment / second_moment / second_moment, 1e-12);
}

TEST(SourceResults, AddUpWhatEachPhaseSays) {
  SourceTotals before{"front", {.received = 100, .lost = 7, .gaps = 1}, {}, 0};
  SourceTotals between{"front", {.received = 300, .lost = 9, .gaps = 1}, {}, 0};
  SourceTotals after{"front", {.received = 350, .lost = 20, .estimated = 3, .gaps = 2}, {}, 0};
  const std::vector<NamedRecord> records{SourceRecord(before, between), SourceRecord(between, after)};
  const auto results = SourceResults(records);
  EXPECT_EQ(FindResult(results, "samples_received_front")->value, 250.0);
  EXPECT_EQ(FindResult(results, "samples_lost_front")->value, 13.0);
  EXPECT_EQ(FindResult(results, "samples_lost_front")->flag,
            "3 of them told from the time that went by, not from a counter");
}

BenchDescription BenchWithATransducer() {
  BenchDescription bench;
  bench.file_name = "lab.yaml";
  bench.transducer.serial = "T-0815";
  bench.transducer.calibration = "C-17";
  bench.transducer.calibration_due = "2026-01-31";
  bench.origins["torque_transducer.calibration_due"] = {12, 20, "2026-01-31", false};
  return bench;
}

constexpr std::chrono::year_month_day Day(int year, unsigned month, unsigned day) {
  return {std::chrono::year(year), std::chrono::month(month), std::chrono::day(day)};
}

TEST(Calibrations, HoldOnTheirLastDayAndBlockTheStartAfterIt) {
  const BenchDescription bench = BenchWithATransducer();
  const auto calibrations = CalibrationsOf(bench);
  EXPECT_TRUE(CalibrationTroubles(calibrations, {}, Day(2026, 1, 31)).empty());
  EXPECT_NO_THROW(RefuseToStart({}, bench));
  const auto troubles = CalibrationTroubles(calibrations, {}, Day(2026, 2, 1));
  try {
    RefuseToStart(troubles, bench);
    ADD_FAILURE() << "an expired calibration has not blocked the start";
  } catch (const BenchError& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kWrongInput);
    EXPECT_EQ(
        std::string(error.what()),
        "lab.yaml:12:20: error: calibration C-17 of channel output_torque was due on 2026-01-31, 1 days "
        "ago (sensor T-0815) (expected a calibration that holds today: have the sensor calibrated and "
        "write the new certificate into the bench file, or start with --accept-expired, and every record "
        "says so)");
  }
}

TEST(Calibrations, AreOfTheSensorThatIsMounted) {
  ChannelCalibration mounted{"output_torque", "T-4711", "Nm", {}};
  const std::vector<ChannelCalibration> devices{mounted};
  const auto troubles = CalibrationTroubles(CalibrationsOf(BenchWithATransducer()), devices, Day(2026, 1, 1));
  ASSERT_EQ(troubles.size(), 1u);
  EXPECT_EQ(troubles[0].words,
            "calibration C-17 of channel output_torque is of sensor T-0815, but sensor T-4711 is mounted "
            "(sensor T-4711)");
}

TEST(Recalibrate, ScalesTheRawCountsAnew) {
  const std::vector<double> counts{-1000.0, 0.0, 12345.0, 800000.0};
  daq::acquisition::Calibration before;
  before.id = "old";
  before.sensitivity = 400.0;
  before.zero = 20.0;
  daq::acquisition::Calibration after;
  after.id = "new";
  after.sensor_serial = "T-0815";
  after.sensitivity = 390.0;
  after.zero = 35.0;
  after.polynomial = {0.1, 1.0, 1e-5};
  NamedRecord named{"lock/hysteresis_1", {}};
  std::vector<double> torque;
  for (const double count : counts) torque.push_back((count - 20.0) / 400.0);
  named.record.columns = {{"torque_Nm", torque, "T-0815", "old"}, {"time_s", torque, "", ""}};
  named.record.columns[0].calibration_terms = AttributesOf(before);
  std::vector<NamedRecord> records{named};
  EXPECT_EQ(Recalibrate(records, std::vector{after}), 1u);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double x = (counts[i] - 35.0) / 390.0;
    EXPECT_NEAR(records[0].record.Doubles("torque_Nm")[i], 0.1 + x + 1e-5 * x * x, 1e-9);
    EXPECT_EQ(records[0].record.Doubles("time_s")[i], torque[i]);
  }
  EXPECT_EQ(records[0].record.columns[0].calibration, "new");
  // Back through the polynomial to the old one: the counts are not lost.
  before.sensor_serial = "T-0815";
  EXPECT_EQ(Recalibrate(records, std::vector{before}), 1u);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    EXPECT_NEAR(records[0].record.Doubles("torque_Nm")[i], torque[i], 1e-9);
  }
}

}  // namespace
}  // namespace strainwave::bench::campaign_parts_test
