// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/simulated_vibration_source.h"

#include <cmath>

#include "analysis/units.h"
#include "bench/campaign/campaign_error.h"
#include "bench/controller/motion.h"
#include "bench/devices/make_machine.h"

namespace strainwave::bench {
namespace {

constexpr std::chrono::milliseconds kPeriod{10};
constexpr double kPeriod_s = 0.01;
constexpr int kPeriodsOfABlock = 10;
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
  output_turns_ = TurnsOf(devices_.sampler.Read(), stream_.ratio);
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
  throw CampaignError(
      ExitCode::kMachineFailed,
      "error: the simulated bench does not reach its speed (expected a speed and a torque that "
      "its drives can give)");
}

SimulatedVibrationSource::Got SimulatedVibrationSource::Next(std::chrono::milliseconds,
                                                             VibrationChunk& chunk) {
  if (static_cast<double>(samples_) / stream_.sample_rate_hz >= stream_.duration_s) return Got::kEnd;
  VibrationBlock block;
  for (int period = 0; period < kPeriodsOfABlock; ++period) Advance();
  devices_.sampler.DrainVibration(block);
  const double from = output_turns_;
  output_turns_ = TurnsOf(devices_.sampler.Read(), stream_.ratio);
  const auto copied = [](const std::vector<float>& samples) {
    return std::vector<double>(samples.begin(), samples.end());
  };
  const std::size_t count = block.accel_x_m_per_s2.size();
  chunk = {.time_ns =
               stream_.start_ns + std::llround(static_cast<double>(samples_) * 1e9 / stream_.sample_rate_hz),
           .sample_rate_hz = stream_.sample_rate_hz,
           .channels = {"accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2", "accel_motor_z_m_per_s2"},
           .samples = {copied(block.accel_x_m_per_s2), copied(block.accel_y_m_per_s2),
                       copied(block.accel_z_m_per_s2), copied(block.accel_motor_z_m_per_s2)},
           .output_turns = {},
           .origin = "simulated bench",
           .trouble = {}};
  // The shaft turns evenly between two readings.
  for (std::size_t i = 0; i < count; ++i) {
    chunk.output_turns.push_back(from + (output_turns_ - from) * static_cast<double>(i) /
                                            static_cast<double>(count));
  }
  samples_ += count;
  return count == 0 ? Got::kNothingYet : Got::kChunk;
}

std::int64_t SimulatedVibrationSource::NowNanoseconds() const {
  return stream_.start_ns + (devices_.clock.Now() - began_).count();
}

}  // namespace strainwave::bench
