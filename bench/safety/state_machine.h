// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace strainwave::bench {

/// What the bench is doing. Torque is possible only in kUnwinding and in the states from kLoadRun to
/// kBlankTest.
enum class BenchState {
  kFaulted,      // at power-up and after every trip: torque off, brakes on, until a person resets
  kIdle,         // reset, waiting for the start action
  kReferencing,  // encoders, torque zero and sensors are checked at standstill
  kUnwinding,    // the load servo at zero torque lets go of a gear that was braked under load
  kReady,        // between phases: torque off, brakes on
  kLoadRun,
  kMeasurementRotation,
  kTransmissionErrorSweep,
  kHysteresisTest,  // input brake locked
  kBlankTest,
  kSoak,         // standstill until a thermal state is reached
  kSensorCheck,  // what sensors show where it is known; nothing turns
  kSuspended,    // standstill until temperature or sensors have recovered
  kStore,
  kFinished,
};

enum class BenchEvent {
  kReset,
  kStart,
  kBeginUnwinding,
  kReferenced,
  kBeginLoadRun,
  kBeginMeasurementRotation,
  kBeginTransmissionErrorSweep,
  kBeginHysteresisTest,
  kBeginBlankTest,
  kBeginSoak,
  kBeginSensorCheck,
  kPhaseEnded,  // done, paused or stopped on request: the bench stands safe and is not at fault
  kSuspend,
  kResume,
  kBeginStore,
  kStored,
  kFinish,
  kFault,
};

/// The state after `event`, or nothing where it is not allowed in `state`. A fault is allowed in every state;
/// a reset only leads to kIdle, from where a distinct start is needed (docs/requirements.md R12 and R17).
std::optional<BenchState> Next(BenchState state, BenchEvent event);

/// Whether a drive may be enabled in this state.
bool TorqueAllowed(BenchState state);

std::string_view Name(BenchState state);

}  // namespace strainwave::bench
