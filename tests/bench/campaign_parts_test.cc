// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/campaign_error.h"
#include "bench/campaign/cycle_results.h"
#include "bench/campaign/cycle_steps.h"
#include "bench/campaign/record_results.h"

namespace strainwave::bench {
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

TEST(StepsOf, PutsTheRepeatsAfterThePreparation) {
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

// Two points a step apart, so that mean and range can be told by head.
NamedRecord Sweep(const std::string& group, double error_deg) {
  NamedRecord named{group, {}};
  named.record.kind = "transmission_error";
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

}  // namespace
}  // namespace strainwave::bench
