// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/devices/simulated/vibration_synthesis.h"
#include "tests/bench/simulated_helpers.h"

namespace strainwave::bench::simulated_vibration_test {
namespace {

namespace model = analysis::model;

constexpr double kRate_Hz = 25600.0;
constexpr double kSpeed_rad_per_s = 251.327412287;  // 2400 rpm

VibrationBlock Record(const model::Vibration& vibration, const model::VibrationSources& sources,
                      double time_s, std::uint64_t key = 1, double bench_time_s = 0.0) {
  VibrationSynthesis synthesis(vibration, 80.0, 3);
  synthesis.Start(kRate_Hz, key, bench_time_s, time_s + 1.0);
  const int steps = static_cast<int>(std::lround(time_s * 1000.0));
  for (int i = 0; i < steps; ++i) {
    synthesis.Advance(1e-3, kSpeed_rad_per_s * 1e-3 * i, kSpeed_rad_per_s * 1e-3 * (i + 1), sources);
  }
  VibrationBlock block;
  synthesis.Drain(block);
  return block;
}

double Rms(const std::vector<float>& samples) {
  double square = 0.0;
  for (const float sample : samples) square += static_cast<double>(sample) * sample;
  return std::sqrt(square / static_cast<double>(samples.size()));
}

// Amplitude of a line, by projection on its order.
double Line(const std::vector<float>& samples, double order) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double angle = order * kSpeed_rad_per_s * static_cast<double>(i) / kRate_Hz;
    sum += static_cast<double>(samples[i]) * std::polar(1.0, -angle);
  }
  return 2.0 * std::abs(sum) / static_cast<double>(samples.size());
}

model::Vibration Steady() {
  model::Vibration vibration;
  vibration.scatter_per_run = vibration.sensor_drift = 0.0;
  return vibration;
}

model::VibrationSources AtReference(const model::Vibration& vibration, const model::WearState& wear = {}) {
  return model::SourcesAt(vibration, {kSpeed_rad_per_s, 40.0, 40.0}, wear);
}

TEST(VibrationSynthesis, MakesEverySampleOfItsTime) {
  const model::Vibration vibration = Steady();
  const VibrationBlock block = Record(vibration, AtReference(vibration), 2.0);
  EXPECT_NEAR(static_cast<double>(block.accel_x_m_per_s2.size()), 51200.0, 1.0);
  EXPECT_EQ(block.accel_x_m_per_s2.size(), block.accel_motor_z_m_per_s2.size());
}

TEST(VibrationSynthesis, HasTheRmsOfItsSources) {
  const model::Vibration vibration = Steady();
  const model::VibrationSources sources = AtReference(vibration);
  const VibrationBlock block = Record(vibration, sources, 4.0);
  // Modulation of the mesh adds a few per cent that the level leaves out.
  EXPECT_NEAR(Rms(block.accel_x_m_per_s2), model::ChannelRms_m_per_s2(vibration, sources, 0),
              0.08 * model::ChannelRms_m_per_s2(vibration, sources, 0));
  EXPECT_NEAR(Rms(block.accel_motor_z_m_per_s2), model::ChannelRms_m_per_s2(vibration, sources, 3),
              0.08 * model::ChannelRms_m_per_s2(vibration, sources, 3));
}

TEST(VibrationSynthesis, TracksItsOrders) {
  const model::Vibration vibration = Steady();
  const model::VibrationSources sources = AtReference(vibration);
  const VibrationBlock block = Record(vibration, sources, 4.0);  // whole turns of the output
  constexpr double kOrders[] = {1.0, 2.0, 4.0, 2.025, 160.0, 162.0};
  for (std::size_t k = 0; k < 6; ++k) {
    const double expected = vibration.order_gain[0][k] * sources.order_m_per_s2[k];
    // The sidebands of one mesh line fall on the other one.
    EXPECT_NEAR(Line(block.accel_x_m_per_s2, kOrders[k]), expected, k < 4 ? 0.02 : 0.1) << kOrders[k];
  }
  EXPECT_LT(Line(block.accel_x_m_per_s2, 3.3), 0.02);
  EXPECT_GT(Line(block.accel_x_m_per_s2, 158.0), 0.02);  // sideband of 160 at two per input turn
}

TEST(VibrationSynthesis, RingsAtTheModesOfTheHousing) {
  model::Vibration vibration = Steady();
  vibration.order_m_per_s2 = {};
  vibration.mode_m_per_s2 = {0.3, 0.0, 0.0};
  vibration.broadband_m_per_s2 = 0.0;
  const model::VibrationSources sources = AtReference(vibration);
  const std::vector<float> samples = Record(vibration, sources, 4.0).accel_x_m_per_s2;
  // Zero crossings of a lightly damped resonance count its frequency.
  int crossings = 0;
  for (std::size_t i = 1; i < samples.size(); ++i)
    crossings += (samples[i - 1] < 0.0f) != (samples[i] < 0.0f);
  EXPECT_NEAR(0.5 * crossings / 4.0, 830.0, 60.0);
}

TEST(VibrationSynthesis, RepeatsItselfForTheSameKeyOnly) {
  const model::Vibration vibration;
  const model::VibrationSources sources = AtReference(vibration);
  const VibrationBlock block = Record(vibration, sources, 0.1, 5);
  EXPECT_EQ(block.accel_y_m_per_s2, Record(vibration, sources, 0.1, 5).accel_y_m_per_s2);
  EXPECT_NE(block.accel_y_m_per_s2, Record(vibration, sources, 0.1, 6).accel_y_m_per_s2);
}

TEST(VibrationSynthesis, DriftsSlowlyInItsSensors) {
  model::Vibration vibration = Steady();
  vibration.sensor_drift = 0.02;
  vibration.broadband_m_per_s2 = vibration.sensor_noise_m_per_s2 = 0.0;
  const model::VibrationSources sources = AtReference(vibration);
  const double now = Rms(Record(vibration, sources, 1.0, 1, 0.0).accel_x_m_per_s2);
  const double soon = Rms(Record(vibration, sources, 1.0, 1, 1800.0).accel_x_m_per_s2);
  const double later = Rms(Record(vibration, sources, 1.0, 1, 90.0 * 3600.0).accel_x_m_per_s2);
  EXPECT_LT(std::abs(soon / now - 1.0), 0.02);
  EXPECT_GT(std::abs(later / now - 1.0), 1e-3);
  EXPECT_LT(std::abs(later / now - 1.0), 0.2);
}

TEST(VibrationSynthesis, LosesWhatNobodyDrainsAndCountsIt) {
  const model::Vibration vibration = Steady();
  const model::VibrationSources sources = AtReference(vibration);
  VibrationSynthesis synthesis(vibration, 80.0, 3);
  synthesis.Start(1000.0, 1, 0.0, 0.5);
  for (int i = 0; i < 100; ++i) synthesis.Advance(1e-2, 2.5 * i, 2.5 * (i + 1), sources);
  VibrationBlock block;
  synthesis.Drain(block);
  EXPECT_EQ(block.accel_x_m_per_s2.size() + synthesis.lost_samples(), 1000u);
  EXPECT_EQ(block.accel_x_m_per_s2.size(), 501u);
}

TEST(BenchVibration, RecordsVibrationWhileItTurns) {
  SimulatedBench bench(model::DefaultPlantModel(), {.seed = 4});
  Driver driver(bench, std::chrono::milliseconds(1));
  driver.BringUp(DriveMode::kSpeed);
  bench.load_servo().CommandTorque(-40.0);
  VibrationBlock still;
  bench.sampler().StartVibration(kRate_Hz);
  driver.Wait(0.5);
  bench.sampler().DrainVibration(still);
  bench.driving_servo().CommandSpeed(kSpeed_rad_per_s);
  driver.Wait(1.0);
  VibrationBlock starting;
  bench.sampler().DrainVibration(starting);
  VibrationBlock turning;
  driver.Wait(1.0);
  bench.sampler().DrainVibration(turning);
  bench.sampler().StopVibration();
  driver.Wait(0.1);
  VibrationBlock stopped;
  bench.sampler().DrainVibration(stopped);
  EXPECT_NEAR(static_cast<double>(turning.accel_x_m_per_s2.size()), kRate_Hz, 1.0);
  EXPECT_LT(Rms(still.accel_x_m_per_s2), 0.05);
  EXPECT_GT(Rms(turning.accel_x_m_per_s2), 0.2);
  EXPECT_TRUE(stopped.accel_x_m_per_s2.empty());
  // The level channel agrees with the strongest of the three.
  const double strongest =
      std::max({Rms(turning.accel_x_m_per_s2), Rms(turning.accel_y_m_per_s2), Rms(turning.accel_z_m_per_s2)});
  EXPECT_NEAR(bench.sampler().Read().vibration_rms_m_per_s2, strongest, 0.25 * strongest);
}

}  // namespace
}  // namespace strainwave::bench::simulated_vibration_test
