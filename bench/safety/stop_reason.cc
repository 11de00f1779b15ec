// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/stop_reason.h"

#include <fmt/core.h>

#include "analysis/units.h"
#include "bench/roles/sampler.h"
#include "bench/safety/texts_apart.h"
#include "bench/text.h"

namespace strainwave::bench {
namespace {

constexpr double kSecondsPerHour = 3600.0;

// A reason carries the channel as a number.
std::string_view NameOf(double channel) {
  return NameOf(static_cast<Channel>(static_cast<unsigned>(channel)));
}

// "60.69 Nm is beyond the limit of 60.00 Nm".
std::string Beyond(double value, double limit, int decimals, std::string_view unit, std::string_view word) {
  const std::vector<std::string> texts = TextsApart(value, {limit}, decimals);
  return Text("{} {} is {} {} {}", texts[0], unit, word, texts[1], unit);
}

std::string BeyondLimit(double value, double limit, int decimals, std::string_view unit) {
  return Beyond(value, limit, decimals, unit, "beyond the limit of");
}

}  // namespace

std::string_view NameOf(Channel channel) {
  switch (channel) {
    case Channel::kInputAngle:
      return "input angle";
    case Channel::kOutputAngle:
      return "output angle";
    case Channel::kInputSpeed:
      return "input speed";
    case Channel::kOutputTorque:
      return "output torque";
    case Channel::kMotorTorque:
      return "motor torque";
    case Channel::kGearTemperature:
      return "gear temperature";
    case Channel::kAmbientTemperature:
      return "ambient temperature";
    case Channel::kVibrationRms:
      return "vibration";
  }
  return "channel";
}

std::string_view NameOf(BenchServo servo) {
  return servo == BenchServo::kDriving ? "driving servo" : "load servo";
}

std::string_view Code(StopCause cause) {
  switch (cause) {
    case StopCause::kNone:
      return "none";
    case StopCause::kOutputTorqueLimit:
      return "output_torque_limit";
    case StopCause::kInputSpeedLimit:
      return "input_speed_limit";
    case StopCause::kGearTemperatureLimit:
      return "gear_temperature_limit";
    case StopCause::kVibrationLimit:
      return "vibration_limit";
    case StopCause::kTwistLimit:
      return "twist_limit";
    case StopCause::kStaleReadings:
      return "stale_readings";
    case StopCause::kImplausibleReading:
      return "implausible_reading";
    case StopCause::kInputAngleApart:
      return "input_angle_apart";
    case StopCause::kDriveFault:
      return "drive_fault";
    case StopCause::kDriveNotReady:
      return "drive_not_ready";
    case StopCause::kDriveSilent:
      return "drive_silent";
    case StopCause::kDriveDroppedOut:
      return "drive_dropped_out";
    case StopCause::kBrakeEngaged:
      return "brake_engaged";
    case StopCause::kTorqueAway:
      return "torque_away";
    case StopCause::kSpeedAway:
      return "speed_away";
    case StopCause::kPositionAway:
      return "position_away";
    case StopCause::kTorqueFactor:
      return "torque_factor";
    case StopCause::kTorqueOfCheck:
      return "torque_of_check";
    case StopCause::kSpeedFactor:
      return "speed_factor";
    case StopCause::kPhaseTimeout:
      return "phase_timeout";
    case StopCause::kTorqueAtRest:
      return "torque_at_rest";
    case StopCause::kReferenceCheck:
      return "reference_check";
    case StopCause::kSensorCheck:
      return "sensor_check";
    case StopCause::kLogFull:
      return "log_full";
    case StopCause::kDidNotCool:
      return "did_not_cool";
    case StopCause::kSensorStayedBad:
      return "sensor_stayed_bad";
    case StopCause::kTemperatureSuspend:
      return "temperature_suspend";
    case StopCause::kSensorSuspend:
      return "sensor_suspend";
    case StopCause::kDiskFull:
      return "disk_full";
    case StopCause::kPauseRequested:
      return "pause";
    case StopCause::kQuickStopRequested:
      return "quick_stop";
    case StopCause::kQuickStopKey:
      return "quick_stop_key";
    case StopCause::kShutdownRequested:
      return "shutdown";
  }
  return "?";
}

std::string Describe(const StopReason& reason) {
  const double value = reason.value;
  const double limit = reason.limit;
  const std::string_view servo = NameOf(reason.servo);
  switch (reason.cause) {
    case StopCause::kNone:
      return "nothing stopped";
    case StopCause::kOutputTorqueLimit:
      return fmt::format("output torque {} (limits.output_torque)", BeyondLimit(value, limit, 2, "Nm"));
    case StopCause::kInputSpeedLimit:
      return fmt::format("input speed {} (limits.input_speed)",
                         BeyondLimit(RpmFromRadPerS(value), RpmFromRadPerS(limit), 0, "rpm"));
    case StopCause::kGearTemperatureLimit:
      return fmt::format("gear temperature {} (limits.gear_temperature)",
                         BeyondLimit(value, limit, 1, "degC"));
    case StopCause::kVibrationLimit:
      return fmt::format("vibration RMS {} (limits.vibration_rms)", BeyondLimit(value, limit, 2, "m/s2"));
    case StopCause::kTwistLimit:
      return fmt::format("twist {} with the input locked (limits.twist)",
                         BeyondLimit(ArcminFromRad(value), ArcminFromRad(limit), 2, "arcmin"));
    case StopCause::kStaleReadings:
      return fmt::format("no fresh readings for {:.0f} ms (at most {:.0f} ms)", value * 1e3, limit * 1e3);
    case StopCause::kImplausibleReading:
      return fmt::format("the {} gives no plausible value", NameOf(value));
    case StopCause::kInputAngleApart:
      return fmt::format(
          "the input angle went {:.1f} deg apart from the driving servo's own position (at most {:.1f} deg): "
          "an encoder that stands still, or slips on its shaft",
          DegFromRad(value), DegFromRad(limit));
    case StopCause::kDriveFault:
      return fmt::format("the {} reports a fault", servo);
    case StopCause::kDriveNotReady:
      return fmt::format("the {} did not reach operation enabled with its brake off within {:.1f} s", servo,
                         limit);
    case StopCause::kDriveSilent:
      return fmt::format("the {} has not told its state for {:.0f} ms (at most {:.0f} ms)", servo,
                         value * 1e3, limit * 1e3);
    case StopCause::kDriveDroppedOut:
      return fmt::format(
          "the {} dropped out of operation enabled by itself: its enable input, safe torque off, supply or "
          "watchdog?",
          servo);
    case StopCause::kBrakeEngaged:
      return fmt::format("the brake of the {} is on though it was released: its relay, supply or feedback?",
                         servo);
    case StopCause::kTorqueAway:
      return fmt::format("the load servo gives {:.1f} of {:.1f} Nm: its torque limit, coupling or current?",
                         value, limit);
    case StopCause::kSpeedAway:
      return fmt::format(
          "the driving servo turns at {:.0f} of {:.0f} rpm: its speed or torque limit, coupling or current?",
          RpmFromRadPerS(value), RpmFromRadPerS(limit));
    case StopCause::kPositionAway:
      return fmt::format(
          "the input is {:.1f} deg from where the driving servo was sent (at most {:.1f} deg): its speed or "
          "torque limit, coupling or current?",
          DegFromRad(value), DegFromRad(limit));
    case StopCause::kTorqueFactor:
      return fmt::format(
          "turning slowly, the transducer shows {:.2f} times the torque that the load servo was asked for "
          "(expected 1 ± {:g}): load_reducer_ratio, the shaft and units of its drive's profile, or factor "
          "and sign "
          "of the transducer?",
          value, limit);
    case StopCause::kTorqueOfCheck:
      return fmt::format(
          "turning slowly, the transducer shows {:.1f} Nm more than at rest where the load servo was asked "
          "for "
          "{:.1f} Nm: load_reducer_ratio, the shaft and units of its drive's profile, or the factor of the "
          "transducer?",
          value, limit);
    case StopCause::kSpeedFactor:
      return fmt::format(
          "turning slowly, the input encoder shows {:.2f} times the speed that the driving servo was asked "
          "for "
          "(expected 1 ± {:g}): counts_per_rev or sign of the encoder, or the units of the drive's profile?",
          value, limit);
    case StopCause::kPhaseTimeout:
      return fmt::format("the phase took {:.0f} s, planned were at most {:.0f} s", value, limit);
    case StopCause::kTorqueAtRest:
      return fmt::format(
          "at rest, with both torques off, the transducer shows {:.1f} Nm (at most {:.1f} Nm), also after "
          "the "
          "load servo has let go of the gear: it has lost its zero, or a shaft is clamped",
          value, limit);
    case StopCause::kReferenceCheck:
      return fmt::format(
          "at rest, input and output encoder are {:.3f} deg of the output from where they were left (at most "
          "{:.3f} deg): somebody has turned a shaft or its coupling, or an encoder counts anew",
          DegFromRad(value), DegFromRad(limit));
    case StopCause::kSensorCheck:
      return "a sensor does not show what it should";
    case StopCause::kLogFull:
      return fmt::format("the phase gave more than the {:.0f} rows set aside for it", limit);
    case StopCause::kTemperatureSuspend:
      return fmt::format("suspended: gear temperature {} (suspend.trip_temperature)",
                         Beyond(value, limit, 1, "degC", "above"));
    case StopCause::kSensorSuspend:
      return fmt::format("suspended: the {} was bad for {:.1f} s (suspend.bad_sensor)", NameOf(value), limit);
    case StopCause::kDidNotCool:
      return fmt::format(
          "the gear did not cool below {:g} degC in {:.3g} h (suspend.resume_temperature, suspend.give_up): "
          "is "
          "the room cooler than that?",
          limit, value / kSecondsPerHour);
    case StopCause::kSensorStayedBad:
      return fmt::format("the {} gave no good value again in {:.3g} h (suspend.give_up)", NameOf(value),
                         limit / kSecondsPerHour);
    case StopCause::kDiskFull:
      return "the disk is nearly full";
    case StopCause::kPauseRequested:
      return "paused on request";
    case StopCause::kQuickStopRequested:
      return "quick stop on request";
    case StopCause::kQuickStopKey:
      return "the quick-stop key was pressed, or its pendant is gone";
    case StopCause::kShutdownRequested:
      return "shut down on request";
  }
  return "?";
}

std::optional<Channel> ChannelOf(const StopReason& reason) {
  switch (reason.cause) {
    case StopCause::kOutputTorqueLimit:
    case StopCause::kTorqueFactor:
    case StopCause::kTorqueOfCheck:
    case StopCause::kTorqueAtRest:
      return Channel::kOutputTorque;
    case StopCause::kInputSpeedLimit:
      return Channel::kInputSpeed;
    case StopCause::kGearTemperatureLimit:
    case StopCause::kTemperatureSuspend:
    case StopCause::kDidNotCool:
      return Channel::kGearTemperature;
    case StopCause::kVibrationLimit:
      return Channel::kVibrationRms;
    case StopCause::kTwistLimit:
      return Channel::kOutputAngle;
    case StopCause::kInputAngleApart:
    case StopCause::kSpeedFactor:
      return Channel::kInputAngle;
    case StopCause::kImplausibleReading:
    case StopCause::kSensorSuspend:
    case StopCause::kSensorStayedBad:
      return static_cast<Channel>(static_cast<unsigned>(reason.value));
    default:
      return std::nullopt;
  }
}

bool IsSuspend(StopCause cause) {
  return cause == StopCause::kTemperatureSuspend || cause == StopCause::kSensorSuspend;
}

bool IsRequest(StopCause cause) {
  return cause == StopCause::kPauseRequested || cause == StopCause::kQuickStopRequested ||
         cause == StopCause::kQuickStopKey || cause == StopCause::kShutdownRequested ||
         cause == StopCause::kDiskFull;
}

bool IsOfADevice(StopCause cause) {
  return cause == StopCause::kDriveFault || cause == StopCause::kDriveNotReady ||
         cause == StopCause::kDriveSilent || cause == StopCause::kDriveDroppedOut ||
         cause == StopCause::kBrakeEngaged || cause == StopCause::kTorqueAway ||
         cause == StopCause::kSpeedAway || cause == StopCause::kPositionAway ||
         cause == StopCause::kTorqueFactor || cause == StopCause::kTorqueOfCheck ||
         cause == StopCause::kSpeedFactor || cause == StopCause::kStaleReadings ||
         cause == StopCause::kImplausibleReading || cause == StopCause::kInputAngleApart ||
         cause == StopCause::kTorqueAtRest || cause == StopCause::kReferenceCheck ||
         cause == StopCause::kSensorStayedBad || cause == StopCause::kSensorCheck;
}

bool IsFault(StopCause cause) { return cause != StopCause::kNone && !IsSuspend(cause) && !IsRequest(cause); }

}  // namespace strainwave::bench
