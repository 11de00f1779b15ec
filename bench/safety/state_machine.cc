// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/state_machine.h"

#include <array>
#include <utility>

namespace strainwave::bench {
namespace {

// What a bench that is ready can begin.
constexpr std::array kFromReady{
    std::pair{BenchEvent::kBeginLoadRun, BenchState::kLoadRun},
    std::pair{BenchEvent::kBeginMeasurementRotation, BenchState::kMeasurementRotation},
    std::pair{BenchEvent::kBeginTransmissionErrorSweep, BenchState::kTransmissionErrorSweep},
    std::pair{BenchEvent::kBeginHysteresisTest, BenchState::kHysteresisTest},
    std::pair{BenchEvent::kBeginBlankTest, BenchState::kBlankTest},
    std::pair{BenchEvent::kBeginSoak, BenchState::kSoak},
    std::pair{BenchEvent::kBeginSensorCheck, BenchState::kSensorCheck},
    std::pair{BenchEvent::kBeginStore, BenchState::kStore},
    std::pair{BenchEvent::kFinish, BenchState::kFinished}};

std::optional<BenchState> NextFromReady(BenchEvent event) {
  for (const auto& [begins, state] : kFromReady) {
    if (begins == event) return state;
  }
  return std::nullopt;
}

std::optional<BenchState> When(bool allowed, BenchState next) {
  return allowed ? std::optional(next) : std::nullopt;
}

}  // namespace

std::optional<BenchState> Next(BenchState state, BenchEvent event) {
  if (event == BenchEvent::kFault) return BenchState::kFaulted;
  switch (state) {
    case BenchState::kFaulted:
      return When(event == BenchEvent::kReset, BenchState::kIdle);
    case BenchState::kIdle:
      return When(event == BenchEvent::kStart, BenchState::kReferencing);
    case BenchState::kReferencing:
      if (event == BenchEvent::kBeginUnwinding) return BenchState::kUnwinding;
      return When(event == BenchEvent::kReferenced, BenchState::kReady);
    case BenchState::kUnwinding:
      return When(event == BenchEvent::kPhaseEnded, BenchState::kReferencing);
    case BenchState::kReady:
      return NextFromReady(event);
    case BenchState::kLoadRun:
    case BenchState::kMeasurementRotation:
    case BenchState::kTransmissionErrorSweep:
    case BenchState::kHysteresisTest:
    case BenchState::kBlankTest:
    case BenchState::kSoak:
    case BenchState::kSensorCheck:
      if (event == BenchEvent::kSuspend) return BenchState::kSuspended;
      return When(event == BenchEvent::kPhaseEnded, BenchState::kReady);
    case BenchState::kSuspended:
      return When(event == BenchEvent::kResume || event == BenchEvent::kPhaseEnded, BenchState::kReady);
    case BenchState::kStore:
      return When(event == BenchEvent::kStored, BenchState::kReady);
    case BenchState::kFinished:
      return std::nullopt;
  }
  return std::nullopt;
}

bool TorqueAllowed(BenchState state) {
  switch (state) {
    case BenchState::kUnwinding:
    case BenchState::kLoadRun:
    case BenchState::kMeasurementRotation:
    case BenchState::kTransmissionErrorSweep:
    case BenchState::kHysteresisTest:
    case BenchState::kBlankTest:
      return true;
    case BenchState::kFaulted:
    case BenchState::kIdle:
    case BenchState::kReferencing:
    case BenchState::kReady:
    case BenchState::kSoak:
    case BenchState::kSensorCheck:
    case BenchState::kSuspended:
    case BenchState::kStore:
    case BenchState::kFinished:
      return false;
  }
  return false;
}

std::string_view Name(BenchState state) {
  switch (state) {
    case BenchState::kFaulted:
      return "faulted";
    case BenchState::kIdle:
      return "idle";
    case BenchState::kReferencing:
      return "referencing";
    case BenchState::kUnwinding:
      return "unwinding";
    case BenchState::kReady:
      return "ready";
    case BenchState::kLoadRun:
      return "load run";
    case BenchState::kMeasurementRotation:
      return "measurement rotation";
    case BenchState::kTransmissionErrorSweep:
      return "transmission-error sweep";
    case BenchState::kHysteresisTest:
      return "hysteresis test, input locked";
    case BenchState::kBlankTest:
      return "blank test";
    case BenchState::kSoak:
      return "soak";
    case BenchState::kSensorCheck:
      return "sensor check";
    case BenchState::kSuspended:
      return "suspended";
    case BenchState::kStore:
      return "store";
    case BenchState::kFinished:
      return "finished";
  }
  return "?";
}

}  // namespace strainwave::bench
