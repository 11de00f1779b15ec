// SPDX-License-Identifier: Apache-2.0
#include "bench/trip_test/simulated_trips.h"

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "bench/configuration/sensors_of.h"
#include "bench/machines/plant_model_of.h"

namespace strainwave::bench {
namespace {

// A reading that drifts by a thousand times its limit a second is beyond it a control period later, whatever
// it was.
constexpr double kDriftPerLimit_per_s = 1e3;
constexpr double kHotter_K = 10.0;
// Of the mechanics: what is less stands, or is no torque.
constexpr double kStands_rad_per_s = 0.05;
constexpr double kNoTorque_Nm = 0.05;

constexpr unsigned BitOf(Channel channel) { return 1U << static_cast<unsigned>(channel); }

Injection Drift(Channel channel, double limit) {
  Injection injection;
  injection.drifting_channels = BitOf(channel);
  injection.drift_per_s = kDriftPerLimit_per_s * limit;
  return injection;
}

// With the fault in the drive that the row is about.
Injection OfDrive(const TripRow& row, const DriveFaults& faults) {
  Injection injection;
  (row.servo == BenchServo::kLoad ? injection.load : injection.driving) = faults;
  return injection;
}

}  // namespace

Injection InjectionFor(const TripRow& row, const TripSettings& settings) {
  const schedules::Limits& limits = settings.limits;
  Injection injection;
  switch (row.cause) {
    case StopCause::kOutputTorqueLimit:
      return Drift(Channel::kOutputTorque, limits.output_torque_Nm);
    case StopCause::kInputSpeedLimit:
      return Drift(Channel::kInputSpeed, limits.input_speed_rad_per_s);
    case StopCause::kVibrationLimit:
      return Drift(Channel::kVibrationRms, limits.vibration_rms_m_per_s2);
    case StopCause::kTwistLimit:
      return Drift(Channel::kOutputAngle, limits.twist_rad);
    case StopCause::kGearTemperatureLimit:
      injection.gear_temperature_degC = limits.gear_temperature_degC + kHotter_K;
      return injection;
    case StopCause::kTemperatureSuspend:
      // Between the two thresholds: above this one, below the limit that stops.
      injection.gear_temperature_degC =
          std::midpoint(settings.suspend.trip_temperature_degC, limits.gear_temperature_degC);
      return injection;
    case StopCause::kStaleReadings:
      injection.sampler_silent = true;
      return injection;
    case StopCause::kImplausibleReading:
    case StopCause::kSensorSuspend:
      injection.dead_channels = BitOf(row.channel.value());
      return injection;
    case StopCause::kInputAngleApart:
      injection.frozen_channels = BitOf(Channel::kInputAngle);
      return injection;
    case StopCause::kDriveFault:
      (row.servo == BenchServo::kLoad ? injection.load_fault : injection.driving_fault) = true;
      return injection;
    case StopCause::kDriveNotReady:
    case StopCause::kDriveDroppedOut:
      return OfDrive(row, {.dropped_out = true});
    case StopCause::kDriveSilent:
      return OfDrive(row, {.silent = true});
    case StopCause::kBrakeEngaged:
      return OfDrive(row, {.brake_on = true});
    case StopCause::kTorqueAway:
      injection.load.share = 0.0;
      return injection;
    case StopCause::kSpeedAway:
      injection.driving.share = 0.5;
      return injection;
    case StopCause::kQuickStopKey:
      injection.quick_stop_pressed = true;
      return injection;
    default:
      throw std::invalid_argument("cause = " + std::string(Code(row.cause)) + " (must be an interlock's)");
  }
}

SimulatedTrips::SimulatedTrips(const BenchDescription& bench, const TripSettings& settings)
    : bench_(bench), settings_(settings) {}

std::string SimulatedTrips::Prepare(const TripRow&) {
  SimulatedBenchSettings settings;
  settings.seed = bench_.simulation.seed;
  settings.time_skew_s = bench_.simulation.time_skew_s;
  settings.has_accelerometers = SensorsOf(bench_).vibration;
  machine_ = std::make_unique<SimulatedMachine>(PlantModelOf(bench_, settings_.specimen.ratio), settings,
                                                SimulatedTest{});
  return {};
}

BenchDevices SimulatedTrips::Devices() { return machine_->Devices(); }

TripMotion SimulatedTrips::MotionFor(const TripRow& row) const {
  if (row.cause == StopCause::kDriveNotReady) return TripMotion::kComingUp;
  return row.cause == StopCause::kTwistLimit ? TripMotion::kLocked : TripMotion::kTurning;
}

void SimulatedTrips::Provoke(const TripRow& row, const ProvokedState&, PhaseRunner&) noexcept {
  machine_->bench().Inject(InjectionFor(row, settings_));
}

bool SimulatedTrips::StandsSafe() noexcept {
  const PlantState plant = machine_->bench().Memory().plant;
  return plant.input_brake_closed && plant.load_brake_closed &&
         std::abs(plant.motor_torque_Nm) < kNoTorque_Nm && std::abs(plant.load_torque_Nm) < kNoTorque_Nm &&
         std::abs(plant.input_speed_rad_per_s) < kStands_rad_per_s &&
         std::abs(plant.output_speed_rad_per_s) < kStands_rad_per_s;
}

}  // namespace strainwave::bench
