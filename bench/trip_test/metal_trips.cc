// SPDX-License-Identifier: Apache-2.0
#include "bench/trip_test/metal_trips.h"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/configuration/sensors_of.h"
#include "bench/text.h"

namespace strainwave::bench {
namespace {

using Kind = MetalWay::Kind;

constexpr double kShareOfReading = 0.5;
constexpr double kColder_K = 1.0;
// By what the drives say; less stands.
constexpr double kStandsByItsDrive_rad_per_s = 0.5;
constexpr double kNever = std::numeric_limits<double>::infinity();

constexpr const char* kSimulatedAlone = "is tested on the simulated bench alone";

bool IsFaulted(const DriveActual& drive) {
  return drive.power == protocols::PowerState::kFault ||
         drive.power == protocols::PowerState::kFaultReactionActive;
}

bool IsOfASensor(StopCause cause) {
  return cause == StopCause::kStaleReadings || cause == StopCause::kImplausibleReading;
}

bool IsOfADrive(StopCause cause) {
  return cause == StopCause::kDriveFault || cause == StopCause::kDriveSilent ||
         cause == StopCause::kDriveDroppedOut;
}

MetalWay OfAChannel(Channel channel, const BenchDescription& bench) {
  if (channel == Channel::kInputSpeed || channel == Channel::kMotorTorque) {
    return {Kind::kNot, "it has no cable of its own: the drive tells it"};
  }
  return {Kind::kAsked, fmt::format("pull the cable of the {}", SensorOf(channel, bench))};
}

}  // namespace

MetalWay WayOnMetal(const TripRow& row, const BenchDescription& bench) {
  const std::string servo(row.servo ? NameOf(*row.servo) : "");
  switch (row.cause) {
    case StopCause::kOutputTorqueLimit:
    case StopCause::kInputSpeedLimit:
    case StopCause::kGearTemperatureLimit:
    case StopCause::kVibrationLimit:
    case StopCause::kTwistLimit:
    case StopCause::kTemperatureSuspend:
      return {Kind::kLowered, {}};
    case StopCause::kStaleReadings:
      return OfAChannel(Channel::kInputAngle, bench);
    case StopCause::kImplausibleReading:
    case StopCause::kSensorSuspend:
      return OfAChannel(row.channel.value(), bench);
    case StopCause::kInputAngleApart:
      return {Kind::kNot, fmt::format("a coupling that slips {}", kSimulatedAlone)};
    case StopCause::kDriveFault:
      return {Kind::kAsked,
              fmt::format("let the drive of the {} report a fault, from its maker's software", servo)};
    case StopCause::kDriveDroppedOut:
      return {Kind::kAsked, fmt::format("open the safe torque off of the {}", servo)};
    case StopCause::kDriveSilent:
      return {Kind::kAsked, fmt::format("pull the bus cable of the {}", servo)};
    case StopCause::kQuickStopKey:
      return {Kind::kAsked, "press the quick-stop key of the pendant"};
    case StopCause::kDriveNotReady:
      return {Kind::kNot, fmt::format("a drive that does not come up {}", kSimulatedAlone)};
    case StopCause::kBrakeEngaged:
      return {Kind::kNot, fmt::format("a brake that closes under a turning shaft {}", kSimulatedAlone)};
    case StopCause::kTorqueAway:
    case StopCause::kSpeedAway:
      return {Kind::kNot, fmt::format("a servo that gives less than is asked for {}", kSimulatedAlone)};
    default:
      return {Kind::kNot, std::string(kSimulatedAlone)};
  }
}

LoweredLimits LoweredFor(const TripRow& row, const ProvokedState& state) {
  LoweredLimits lowered{{kNever, kNever, kNever, kNever, kNever}, kNever};
  const Readings& now = state.readings;
  switch (row.cause) {
    case StopCause::kOutputTorqueLimit:
      lowered.limits.output_torque_Nm = kShareOfReading * std::abs(now.output_torque_Nm);
      break;
    case StopCause::kInputSpeedLimit:
      lowered.limits.input_speed_rad_per_s = kShareOfReading * std::abs(now.input_speed_rad_per_s);
      break;
    case StopCause::kGearTemperatureLimit:
      lowered.limits.gear_temperature_degC = now.gear_temperature_degC - kColder_K;
      break;
    case StopCause::kVibrationLimit:
      lowered.limits.vibration_rms_m_per_s2 = kShareOfReading * now.vibration_rms_m_per_s2;
      break;
    case StopCause::kTwistLimit:
      lowered.limits.twist_rad = kShareOfReading * std::abs(state.twist_rad);
      break;
    case StopCause::kTemperatureSuspend:
      lowered.trip_temperature_degC = now.gear_temperature_degC - kColder_K;
      break;
    default:
      break;
  }
  return lowered;
}

MetalTrips::MetalTrips(BenchMachine& machine, const BenchDescription& bench, TripPerson person)
    : machine_(machine), bench_(bench), person_(std::move(person)) {}

std::string MetalTrips::Prepare(const TripRow& row) {
  told_ = false;
  provoked_ = {};
  const MetalWay way = WayOnMetal(row, bench_);
  if (way.kind == Kind::kNot) return way.words;
  if (const std::string missing = machine_.AwaitValues(person_.given_up); !missing.empty()) return missing;
  if (way.kind == Kind::kLowered) return {};
  if (!person_.ask) return "nobody is asked: " + way.words;
  const std::string where =
      MotionFor(row) == TripMotion::kStandstill ? "the bench stands still" : "the shafts turn slowly";
  const auto why_not =
      person_.ask(fmt::format("{}: get ready to {}, while {}", row.signal, way.words, where));
  return why_not.value_or("");
}

TripMotion MetalTrips::MotionFor(const TripRow& row) const {
  if (row.cause == StopCause::kTwistLimit) return TripMotion::kLocked;
  const bool turns =
      WayOnMetal(row, bench_).kind == Kind::kLowered || row.cause == StopCause::kDriveDroppedOut;
  return turns ? TripMotion::kTurning : TripMotion::kStandstill;
}

bool MetalTrips::ProvokesItself(const TripRow& row) const {
  return WayOnMetal(row, bench_).kind == Kind::kLowered;
}

void MetalTrips::Provoke(const TripRow& row, const ProvokedState& state, PhaseRunner& runner) noexcept {
  if (row.cause != StopCause::kTwistLimit && MotionFor(row) != TripMotion::kTurning) return;
  const LoweredLimits lowered = LoweredFor(row, state);
  provoked_ = state;
  runner.LowerLimits(lowered.limits, lowered.trip_temperature_degC);
}

// A cable that is pulled is no reading or no value, by the device; an open safe torque off a fault or a drive
// that dropped out.
bool MetalTrips::Accepts(const TripRow& row, const StopReason& reason) const {
  if (IsAbout(row, reason)) return true;
  if (ProvokesItself(row)) return false;
  if (IsOfADrive(row.cause)) return IsOfADrive(reason.cause) && reason.servo == row.servo;
  return IsOfASensor(row.cause) && IsOfASensor(reason.cause);
}

std::string MetalTrips::HowProvoked(const TripRow& row) const {
  if (!ProvokesItself(row)) return {};
  const LoweredLimits lowered = LoweredFor(row, provoked_);
  switch (row.cause) {
    case StopCause::kOutputTorqueLimit:
      return Text("limit lowered to {:.2f} Nm", lowered.limits.output_torque_Nm);
    case StopCause::kInputSpeedLimit:
      return Text("limit lowered to {:.1f} rpm", RpmFromRadPerS(lowered.limits.input_speed_rad_per_s));
    case StopCause::kGearTemperatureLimit:
      return Text("limit lowered to {:.1f} degC", lowered.limits.gear_temperature_degC);
    case StopCause::kVibrationLimit:
      return Text("limit lowered to {:.3f} m/s2", lowered.limits.vibration_rms_m_per_s2);
    case StopCause::kTwistLimit:
      return Text("limit lowered to {:.2f} arcmin", ArcminFromRad(lowered.limits.twist_rad));
    case StopCause::kTemperatureSuspend:
      return Text("threshold lowered to {:.1f} degC", lowered.trip_temperature_degC);
    default:
      return {};
  }
}

void MetalTrips::Beat(const TripRow& row) {
  if (told_ || ProvokesItself(row)) return;
  told_ = true;
  person_.tell("now: " + WayOnMetal(row, bench_).words);
}

bool MetalTrips::StandsSafe() noexcept {
  const auto stands = [](const DriveActual& drive) {
    return drive.brake_engaged && drive.power != protocols::PowerState::kOperationEnabled &&
           std::abs(drive.speed_rad_per_s) < kStandsByItsDrive_rad_per_s;
  };
  BenchDevices devices = machine_.Devices();
  return stands(devices.driving.Actual()) && stands(devices.load.Actual());
}

void MetalTrips::Finish(const TripRow& row) {
  if (!ProvokesItself(row)) {
    person_.ask("make everything as it was before");
    person_.wait_until_ready();
  }
  BenchDevices devices = machine_.Devices();
  for (ServoDrive* const drive : {&devices.driving, &devices.load}) {
    if (IsFaulted(drive->Actual())) drive->ResetFault();
  }
}

}  // namespace strainwave::bench
