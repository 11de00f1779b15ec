// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "bench/roles/sampler.h"

namespace strainwave::bench {

/// Why a running phase left its body before it was done. The cyclic path carries this; words come later.
enum class StopCause {
  kNone,
  // Limits and faults: the bench is faulted afterwards.
  kOutputTorqueLimit,
  kInputSpeedLimit,
  kGearTemperatureLimit,
  kVibrationLimit,
  kTwistLimit,
  kStaleReadings,
  kImplausibleReading,
  kInputAngleApart,
  kDriveFault,
  kDriveNotReady,
  kDriveSilent,
  kDriveDroppedOut,
  kBrakeEngaged,
  kTorqueAway,
  kSpeedAway,
  kPositionAway,
  kTorqueFactor,
  kTorqueOfCheck,
  kSpeedFactor,
  kPhaseTimeout,
  kTorqueAtRest,
  kReferenceCheck,
  kSensorCheck,
  kLogFull,
  kDidNotCool,       // suspended, and given up
  kSensorStayedBad,  // the same
  // Suspension: the phase goes on or starts again when the condition has passed.
  kTemperatureSuspend,
  kSensorSuspend,
  // The campaign asked for it, whose disk fills.
  kDiskFull,
  // A person asked for it.
  kPauseRequested,
  kQuickStopRequested,
  kQuickStopKey,
  kShutdownRequested,
};

/// The two servos of a bench, each a drive with its motor and holding brake.
enum class BenchServo { kDriving, kLoad };

struct StopReason {
  StopCause cause{StopCause::kNone};
  double value{};
  double limit{};
  std::chrono::nanoseconds time{};
  BenchServo servo{};  // where the cause is one of a drive

  explicit operator bool() const { return cause != StopCause::kNone; }
};

/// "output torque", "driving servo": as sentences for people name them.
std::string_view NameOf(Channel channel);
std::string_view NameOf(BenchServo servo);

/// Short name for the journal ("output_torque_limit").
std::string_view Code(StopCause cause);

/// One sentence for a technician, with the value, the limit, their units, and the schedule's key.
std::string Describe(const StopReason& reason);

/// The channel that it was seen in; none where it was in no one channel.
std::optional<Channel> ChannelOf(const StopReason& reason);

bool IsFault(StopCause cause);
bool IsSuspend(StopCause cause);
/// Asked for, by a person or the campaign: nothing is wrong with the bench.
bool IsRequest(StopCause cause);
/// A fault of a drive or a sensor, not of what it drives or measures.
bool IsOfADevice(StopCause cause);

}  // namespace strainwave::bench
