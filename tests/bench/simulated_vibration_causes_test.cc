// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/devices/simulated/vibration_synthesis.h"
#include "tests/bench/causes_helpers.h"

namespace strainwave::bench::simulated_vibration_causes_test {
namespace {

constexpr double kRate_Hz = 25600.0;
constexpr double kReference_rad_per_s = 251.327412287;  // 2400 rpm

// Four seconds of the x channel at a speed, of what the causes alone make.
std::vector<float> Record(const model::VibrationCauses& causes,
                          double speed_rad_per_s = kReference_rad_per_s) {
  const model::Vibration silent = [] {
    model::Vibration vibration;
    vibration.scatter_per_run = vibration.sensor_drift = vibration.sensor_noise_m_per_s2 = 0.0;
    vibration.order_m_per_s2 = {};
    vibration.mode_m_per_s2 = {};
    vibration.broadband_m_per_s2 = 0.0;
    return vibration;
  }();
  VibrationSynthesis synthesis(silent, 80.0, 3, causes);
  synthesis.Start(kRate_Hz, 1, 0.0, 5.0);
  const model::VibrationSources none = model::SourcesAt(silent, {speed_rad_per_s, 40.0, 40.0}, {});
  for (int i = 0; i < 4000; ++i) {
    synthesis.Advance(1e-3, speed_rad_per_s * 1e-3 * i, speed_rad_per_s * 1e-3 * (i + 1), none);
  }
  VibrationBlock block;
  synthesis.Drain(block);
  return block.accel_x_m_per_s2;
}

std::complex<double> AtFrequency(const std::vector<float>& samples, double frequency_rad_per_s) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    sum += static_cast<double>(samples[i]) *
           std::polar(1.0, -frequency_rad_per_s * static_cast<double>(i) / kRate_Hz);
  }
  return 2.0 * sum / static_cast<double>(samples.size());
}
double Line(const std::vector<float>& samples, double order, double speed_rad_per_s = kReference_rad_per_s) {
  return std::abs(AtFrequency(samples, order * speed_rad_per_s));
}

double MeanSquare(const std::vector<float>& samples) {
  double square = 0.0;
  for (const float sample : samples) square += static_cast<double>(sample) * sample;
  return square / static_cast<double>(samples.size());
}

TEST(SimulatedBearingDefect, HasItsOrderWithTwoSidebands) {
  model::VibrationCauses causes;
  causes.bearing.amplitude_m_per_s2 = 0.3;
  causes.bearing.modulation = 0.6;
  const std::vector<float> samples = Record(causes);
  EXPECT_NEAR(Line(samples, 10.35), 0.3, 1e-3);
  EXPECT_NEAR(Line(samples, 12.35), 0.09, 1e-3);
  EXPECT_NEAR(Line(samples, 8.35), 0.09, 1e-3);
  // Half the speed, half the size.
  EXPECT_NEAR(Line(Record(causes, 0.5 * kReference_rad_per_s), 10.35, 0.5 * kReference_rad_per_s), 0.15,
              1e-3);
}

TEST(SimulatedBearingDefect, LetsAModeRingAtEachPassing) {
  model::VibrationCauses causes;
  causes.bearing.ringing.amplitude_m_per_s2 = 1.0;
  causes.bearing.modulation = 0.0;
  causes.bearing.ringing.mode_damping = 0.1;  // a ring has died away before the next one
  const std::vector<float> samples = Record(causes);
  // A decaying ring of crest r has r²/(4ζω) of energy; 10.35 · 40 of them a second.
  const double energy = 1.0 / (4.0 * 0.1 * kTwoPi * 3600.0);
  EXPECT_NEAR(MeanSquare(samples), energy * 10.35 * 40.0, 0.1 * energy * 10.35 * 40.0);
  // Near the mode the lines are harmonics of the passing order, and nothing is between them.
  const double harmonic = std::round(3600.0 / (10.35 * 40.0));
  EXPECT_GT(Line(samples, harmonic * 10.35), 0.05);
  EXPECT_LT(Line(samples, (harmonic + 0.5) * 10.35), 0.005);
}

TEST(SimulatedImbalance, RisesWithTheSquareOfTheSpeed) {
  model::VibrationCauses causes;
  causes.imbalance.amplitude_m_per_s2 = 0.05;
  for (const double speed_rpm : {1000.0, 2400.0, 3000.0}) {
    const double speed = RadPerSFromRpm(speed_rpm);
    EXPECT_NEAR(Line(Record(causes, speed), 1.0, speed), 0.05 * std::pow(speed_rpm / 1000.0, 2), 2e-3);
  }
}

TEST(SimulatedFlexsplineCrack, HasItsOrderHarmonicsAndOutputModulation) {
  model::VibrationCauses causes;
  causes.crack.amplitude_m_per_s2 = 0.4;
  causes.crack.modulation = 0.5;
  const std::vector<float> samples = Record(causes);  // two turns of the output
  EXPECT_NEAR(Line(samples, 2.025), 0.4, 2e-3);
  EXPECT_NEAR(Line(samples, 4.05), 0.2, 2e-3);
  EXPECT_NEAR(Line(samples, 2.025 + 0.0125), 0.1, 2e-3);
  EXPECT_NEAR(Line(samples, 2.025 - 0.0125), 0.1, 2e-3);
}

TEST(SimulatedFlexsplineCrack, LetsAModeRingAtEachPassing) {
  model::VibrationCauses causes;
  causes.crack.ringing = {1.0, 2400.0, 0.05};
  causes.crack.modulation = 0.0;
  const std::vector<float> samples = Record(causes);
  // 2.025 · 40 impacts a second of r²/(4ζω) each.
  const double square = 2.025 * 40.0 / (4.0 * 0.05 * kTwoPi * 2400.0);
  EXPECT_NEAR(MeanSquare(samples), square, 0.1 * square);
  const double harmonic = std::round(2400.0 / (2.025 * 40.0));
  EXPECT_GT(Line(samples, harmonic * 2.025), 5.0 * Line(samples, (harmonic + 0.5) * 2.025));
}

TEST(SimulatedTorsionalMode, RingsInANarrowBand) {
  model::VibrationCauses causes;
  causes.mode.deviation_m_per_s2 = 0.2;
  causes.mode.frequency_Hz = 140.0;
  causes.mode.damping = 0.03;
  const std::vector<float> samples = Record(causes);
  // Of some 2ζω · 4 s = 200 independent values.
  EXPECT_NEAR(std::sqrt(MeanSquare(samples)), 0.2, 0.04);
  int crossings = 0;
  for (std::size_t i = 1; i < samples.size(); ++i)
    crossings += (samples[i - 1] < 0.0F) != (samples[i] < 0.0F);
  EXPECT_NEAR(0.5 * crossings / 4.0, 140.0, 6.0);
}

TEST(SimulatedTorsionalMode, RaisesTheLineThatMeetsIt) {
  model::VibrationCauses causes;
  causes.mode.line_m_per_s2 = 0.02;
  causes.mode.frequency_Hz = 80.0;  // twice a turn at 2400 rpm
  causes.mode.damping = 0.04;
  EXPECT_NEAR(Line(Record(causes), 2.0), 0.02 / 0.08, 2e-3);
  // An octave below: x²/(1 − x²) of it with x = 1/2, but for the damping.
  const double slow = 0.5 * kReference_rad_per_s;
  EXPECT_NEAR(Line(Record(causes, slow), 2.0, slow), 0.02 / 3.0, 2e-4);
}

TEST(SimulatedVibration, ShowsDefectsInTheLevelOfTheBench) {
  const auto level = [](std::initializer_list<Change> changes) {
    SimulatedBench bench(Quiet(changes), {.seed = 4});
    Driver driver(bench);
    driver.BringUp(DriveMode::kSpeed);
    bench.driving_servo().CommandSpeed(kReference_rad_per_s);
    bench.load_servo().CommandTorque(-40.0);
    driver.Wait(3.0);
    double sum = 0.0;
    for (int i = 0; i < 200; ++i) {
      driver.Steps(1);
      sum += bench.sampler().Read().vibration_rms_m_per_s2 / 200.0;
    }
    return sum;
  };
  const double healthy = level({});
  const double cracked = level({{"vibration_flexspline_crack", "amplitude_m_per_s2", 2.0},
                                {"vibration_flexspline_crack", "harmonic_share", 0.0},
                                {"vibration_flexspline_crack", "modulation", 0.0}});
  // The channel that is strongest hears the housing with a gain from 0.5 to 1.
  EXPECT_GT(cracked * cracked - healthy * healthy, 0.9 * 0.5 * 0.25 * 4.0);
  EXPECT_LT(cracked * cracked - healthy * healthy, 1.1 * 0.5 * 4.0);
}

}  // namespace
}  // namespace strainwave::bench::simulated_vibration_causes_test
