// SPDX-License-Identifier: Apache-2.0
// A torque amplifier or an encoder whose samples come late, with the time when they were taken: what is
// measured is what it is with one that is on time.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bench/campaign/record_results.h"
#include "bench/controller/make_program.h"
#include "tests/simulation/bench_fixture.h"

namespace strainwave::bench::late_samples_test {
namespace {

// By how many readings a channel is late.
struct Lateness {
  std::size_t torque{}, input_angle{}, output_angle{};
};

// Tells what was so many readings ago, and its time.
class LateSampler final : public Sampler {
 public:
  LateSampler(Sampler& sampler, const Lateness& late) : sampler_(sampler), late_(late) {}

  Readings Read() noexcept override {
    Readings readings = sampler_.Read();
    past_[count_ % past_.size()] = readings;
    const auto before = [&](std::size_t late) {
      return past_[(count_ - std::min(late, count_)) % past_.size()];
    };
    const Readings torque = before(late_.torque);
    readings.output_torque_Nm = torque.output_torque_Nm;
    readings.torque_time = torque.torque_time;
    const Readings input = before(late_.input_angle);
    readings.input_angle_rad = input.input_angle_rad;
    readings.input_angle_time = input.input_angle_time;
    const Readings output = before(late_.output_angle);
    readings.output_angle_rad = output.output_angle_rad;
    readings.output_angle_time = output.output_angle_time;
    ++count_;
    return readings;
  }
  void StartVibration(double rate_hz) override { sampler_.StartVibration(rate_hz); }
  void StopVibration() override { sampler_.StopVibration(); }
  void DrainVibration(VibrationBlock& block) override { sampler_.DrainVibration(block); }

 private:
  Sampler& sampler_;
  Lateness late_;
  std::size_t count_{};
  std::array<Readings, 16> past_{};
};

// Of the record of this name, on a simulated bench whose samples are late.
template <typename Phase>
daq::Record RecordOf(const Phase& phase, double period_s, std::string_view name, const Lateness& late) {
  SimulatedMachine machine(analysis::model::DefaultPlantModel(), {}, {});
  LateSampler sampler(machine.bench().sampler(), late);
  std::atomic<StopRequest> request{StopRequest::kNone};
  PhaseRunner runner(
      {machine.bench().driving_servo(), machine.bench().load_servo(), sampler, machine.bench().clock()},
      TestSettings(), request);
  const auto program = MakeProgram(phase, TestSpecimen(), 0.0, period_s);
  PhaseOutcome outcome = runner.Run(*program, NoHeartbeat);
  EXPECT_FALSE(outcome.reason) << Describe(outcome.reason);
  const auto found = std::ranges::find(outcome.records, name, &NamedRecord::group);
  if (found == outcome.records.end()) throw std::runtime_error("no record of this name");
  return std::move(found->record);
}

// Width of the first loop, and K1.
std::pair<double, double> LoopWith(const Lateness& late) {
  schedules::HysteresisTest test = TestHysteresis();
  test.torque_rate_Nm_per_s = 20.0;
  test.log_rate_hz = 100.0;
  test.lock_angles_rad = {0.0};
  const auto stiffness =
      StiffnessOf(RecordOf(test, 0.01, "hysteresis_1", late), analysis::StiffnessMethod::kModel, {});
  return {ArcminFromRad(stiffness.hysteresis_rad.value), stiffness.k1_Nm_per_rad.value};
}

// 30 ms at 20 Nm/s are 0.6 Nm each way: 0.26' of width where they are not known.
TEST(LateTorque, DoesNotWidenTheLoop) {
  const auto [width_arcmin, k1_Nm_per_rad] = LoopWith({});
  const auto [late_width_arcmin, late_k1_Nm_per_rad] = LoopWith({.torque = 3});
  EXPECT_NEAR(late_width_arcmin, width_arcmin, 0.01);
  EXPECT_NEAR(late_k1_Nm_per_rad, k1_Nm_per_rad, 0.005 * k1_Nm_per_rad);
}

// The transmission error of a rotation: its mean, and its part of two periods a turn of the input, by which
// the wave generator's angle is told.
struct ErrorOfRotation {
  double mean_arcmin{}, cosine_arcmin{}, sine_arcmin{};
  std::size_t rows{};
  double time_from_s{}, time_to_s{}, turned_rad{};
};
ErrorOfRotation RotationWith(const Lateness& late) {
  const schedules::Specimen specimen = TestSpecimen();
  const daq::Record record = RecordOf(TestRotation(), 0.01, "rotation", late);
  const std::vector<double> input_rad = record.CopyAsDoubles("position_rad");
  const std::vector<double> output_deg = record.CopyAsDoubles("output_angle_deg");
  const auto time_s = record.Doubles("time_s");
  ErrorOfRotation error;
  error.rows = input_rad.size();
  for (std::size_t i = 0; i < input_rad.size(); ++i) {
    const double error_arcmin = ArcminFromRad(input_rad[i] / specimen.ratio) - 60.0 * output_deg[i];
    error.mean_arcmin += error_arcmin;
    error.cosine_arcmin += 2.0 * error_arcmin * std::cos(2.0 * input_rad[i]);
    error.sine_arcmin += 2.0 * error_arcmin * std::sin(2.0 * input_rad[i]);
  }
  for (double* sum : {&error.mean_arcmin, &error.cosine_arcmin, &error.sine_arcmin}) {
    *sum /= static_cast<double>(error.rows);
  }
  error.time_from_s = time_s.front();
  error.time_to_s = time_s.back();
  error.turned_rad = input_rad.back() - input_rad.front();
  return error;
}

// At 2400 rpm 7 ms are 75' of the output, and of the error's two periods a turn they are 201 degrees.
TEST(LateEncoder, DoesNotShiftTheTransmissionErrorOfARotation) {
  const schedules::MeasurementRotation rotation = TestRotation();
  const ErrorOfRotation in_time = RotationWith({});
  ASSERT_GT(std::hypot(in_time.cosine_arcmin, in_time.sine_arcmin), 0.1) << "nothing to shift";
  for (const Lateness late : {Lateness{.output_angle = 7}, Lateness{.input_angle = 7},
                              Lateness{.torque = 15, .input_angle = 3, .output_angle = 9}}) {
    SCOPED_TRACE(testing::Message() << "torque " << late.torque << ", input " << late.input_angle
                                    << ", output " << late.output_angle << " ms late");
    const ErrorOfRotation error = RotationWith(late);
    // The turn begins at another sample of the input, so that the noise of the encoders, 0.05' in a row at
    // most, is another: 0.05' / sqrt(2000 rows) of it, five times.
    constexpr double kNoise_arcmin = 0.006;
    EXPECT_NEAR(error.mean_arcmin, in_time.mean_arcmin, kNoise_arcmin);
    EXPECT_NEAR(error.cosine_arcmin, in_time.cosine_arcmin, kNoise_arcmin);
    EXPECT_NEAR(error.sine_arcmin, in_time.sine_arcmin, kNoise_arcmin);
    // Rows of the whole turn, none left out, with the times of their samples. A turn begins at 0.995 of the
    // speed.
    EXPECT_NEAR(error.turned_rad, 80.0 * kTwoPi, 2.0 * rotation.input_speed_rad_per_s / rotation.log_rate_hz);
    const double took_s = error.time_to_s - error.time_from_s;
    EXPECT_NEAR(took_s, static_cast<double>(error.rows - 1) / rotation.log_rate_hz, 1e-9);
    EXPECT_NEAR(error.turned_rad / took_s, rotation.input_speed_rad_per_s,
                0.005 * rotation.input_speed_rad_per_s);
  }
}

// What the devices' times tell is no skew any more, and rows are of moments at which both stand.
TEST(LateEncoder, DoesNotShiftTheTransmissionErrorOfASweep) {
  schedules::TransmissionErrorSweep sweep = TestSweep();
  sweep.step_rad = RadFromDeg(5.0);
  sweep.steps = 12;
  constexpr double kPeriod_s = 0.002;
  const auto sweep_with = [&](const Lateness& late) {
    return RecordOf(sweep, kPeriod_s, "transmission_error", late);
  };
  const daq::Record in_time = sweep_with({});
  for (const Lateness late : {Lateness{.output_angle = 10}, Lateness{.torque = 4, .input_angle = 10}}) {
    SCOPED_TRACE(testing::Message() << "input " << late.input_angle << ", output " << late.output_angle
                                    << " readings late");
    const daq::Record record = sweep_with(late);
    const double skew_us = daq::NumberFromText(record.Metadata("encoder_skew_us").value()).value();
    const double error_us = daq::NumberFromText(record.Metadata("encoder_skew_se_us").value()).value();
    EXPECT_NEAR(skew_us, 0.0, 5.0 * error_us);
    EXPECT_LT(error_us, 20.0) << "of 20 000";
    for (const char* angle : {"input_angle_deg", "output_angle_deg"}) {
      const auto late_deg = record.Doubles(angle);
      const auto in_time_deg = in_time.Doubles(angle);
      ASSERT_EQ(late_deg.size(), in_time_deg.size());
      // At rest, with another noise.
      constexpr double kNoise_deg = 0.05 / 60.0;
      for (std::size_t i = 0; i < late_deg.size(); ++i)
        EXPECT_NEAR(late_deg[i], in_time_deg[i], 80.0 * kNoise_deg);
    }
    EXPECT_LT(record.Doubles("time_s").front(), in_time.Doubles("time_s").front() + 0.01 + 10.0 * kPeriod_s);
  }
}

}  // namespace
}  // namespace strainwave::bench::late_samples_test
