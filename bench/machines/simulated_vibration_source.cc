// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/simulated_vibration_source.h"

#include <array>
#include <cmath>
#include <iterator>

#include "analysis/units.h"
#include "bench/controller/motion.h"
#include "bench/controller/phase_program.h"
#include "bench/errors/bench_error.h"
#include "bench/machines/make_machine.h"

namespace strainwave::bench {
namespace {

constexpr std::chrono::milliseconds kPeriod{10};
constexpr double kPeriod_s = 0.01;
constexpr std::size_t kPeriodsOfABlock = 10;
constexpr double kAcceleration_rad_per_s2 = 1000.0;
constexpr double kTorqueRate_Nm_per_s = 200.0;
constexpr double kSpeedReached = 0.995;
constexpr int kMostPeriods = 6000;

double TurnsOf(const Readings& readings, double ratio) { return readings.input_angle_rad / (kTwoPi * ratio); }

}  // namespace

SimulatedVibrationSource::SimulatedVibrationSource(const BenchDescription& description,
                                                   const SimulatedStream& stream)
    : stream_(stream),
      machine_(MakeMachine(description, {.ratio = stream.ratio, .pace = stream.pace, .truth = {}})),
      devices_(machine_->Devices()) {
  machine_->BeginPhase(1);
  RunUp();
  devices_.sampler.StartVibration(stream_.sample_rate_hz);
  began_ = devices_.clock.Now();
  last_ = devices_.sampler.Read();
}

SimulatedVibrationSource::~SimulatedVibrationSource() {
  devices_.driving.QuickStop();
  devices_.load.QuickStop();
}

void SimulatedVibrationSource::Advance() { devices_.clock.SleepUntil(devices_.clock.Now() + kPeriod); }

void SimulatedVibrationSource::RunUp() {
  devices_.driving.Enable(DriveMode::kSpeed);
  devices_.load.Enable(DriveMode::kTorque);
  Ramp speed(kAcceleration_rad_per_s2);
  Ramp torque(kTorqueRate_Nm_per_s);
  for (int period = 0; period < kMostPeriods; ++period) {
    Advance();
    const Readings readings = devices_.sampler.Read();
    const bool driving_up = BroughtUp(devices_.driving);
    if (!BroughtUp(devices_.load) || !driving_up) continue;
    devices_.driving.CommandSpeed(speed.Step(stream_.input_speed_rad_per_s, kPeriod_s));
    devices_.load.CommandTorque(torque.Step(-stream_.output_torque_Nm, kPeriod_s));
    if (readings.input_speed_rad_per_s > kSpeedReached * stream_.input_speed_rad_per_s &&
        torque.value() == -stream_.output_torque_Nm) {
      return;
    }
  }
  throw BenchError(ExitCode::kMachineFailed,
                   "error: the simulated bench does not reach its speed (expected a speed and a torque that "
                   "its drives can give)");
}

SimulatedVibrationSource::Got SimulatedVibrationSource::Next(std::chrono::milliseconds,
                                                             VibrationChunk& chunk) {
  if (static_cast<double>(samples_) / stream_.sample_rate_hz >= stream_.duration_s) return Got::kEnd;
  VibrationBlock block;
  std::array<Readings, kPeriodsOfABlock + 1> readings{last_};
  for (std::size_t period = 1; period < readings.size(); ++period) {
    Advance();
    readings[period] = devices_.sampler.Read();
  }
  devices_.sampler.DrainVibration(block);
  last_ = readings.back();
  const auto copied = [](const std::vector<float>& samples) {
    return std::vector<double>(samples.begin(), samples.end());
  };
  const std::size_t count = block.accel_x_m_per_s2.size();
  chunk = {.time_ns =
               stream_.start_ns + std::llround(static_cast<double>(samples_) * 1e9 / stream_.sample_rate_hz),
           .sample_rate_hz = stream_.sample_rate_hz,
           .channels = {"accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2", "accel_motor_z_m_per_s2",
                        "motor_torque_Nm", "output_torque_Nm", "temperature_degC"},
           .samples = {copied(block.accel_x_m_per_s2),
                       copied(block.accel_y_m_per_s2),
                       copied(block.accel_z_m_per_s2),
                       copied(block.accel_motor_z_m_per_s2),
                       {},
                       {},
                       {}},
           .output_turns = {},
           .origin = "simulated bench",
           .trouble = {}};
  // The slow channels go evenly from one reading to the next.
  for (std::size_t i = 0; i < count; ++i) {
    const double place = static_cast<double>(i * kPeriodsOfABlock) / static_cast<double>(count);
    const auto period = static_cast<std::size_t>(place);
    const Readings& before = readings[period];
    const Readings& after = readings[period + 1];
    const double share = place - static_cast<double>(period);
    chunk.output_turns.push_back(
        std::lerp(TurnsOf(before, stream_.ratio), TurnsOf(after, stream_.ratio), share));
    const double slow[] = {std::lerp(before.motor_torque_Nm, after.motor_torque_Nm, share),
                           std::lerp(before.output_torque_Nm, after.output_torque_Nm, share),
                           std::lerp(before.gear_temperature_degC, after.gear_temperature_degC, share)};
    for (std::size_t k = 0; k < std::size(slow); ++k)
      chunk.samples[chunk.samples.size() - std::size(slow) + k].push_back(slow[k]);
  }
  samples_ += count;
  return count == 0 ? Got::kNothingYet : Got::kChunk;
}

std::int64_t SimulatedVibrationSource::NowNanoseconds() const {
  return stream_.start_ns + (devices_.clock.Now() - began_).count();
}

}  // namespace strainwave::bench
