// SPDX-License-Identifier: Apache-2.0
// What comes before the first cycle of a run: references, the load check, and warming up after a pause.
#include <algorithm>
#include <iterator>
#include <limits>

#include <fmt/core.h>

#include "analysis/units.h"
#include "bench/campaign/campaign_runner.h"
#include "bench/controller/load_check_program.h"
#include "bench/controller/make_program.h"
#include "bench/controller/standstill_programs.h"
#include "bench/controller/unwind_program.h"

namespace strainwave::bench {
namespace {

// Referencing: more than this at rest is a transducer that has lost its zero, or a shaft that is clamped.
constexpr double kTorqueZeroShareOfRange = 0.05;
// One tooth of a size-20 flexspline is 2.25°; wind-up, transmission error and encoder errors stay below 0.3°.
constexpr double kEncoderOffsetTolerance_rad = RadFromDeg(0.5);

bool AppliesLoad(const schedules::PhaseParameters& parameters) {
  if (const auto* check = std::get_if<schedules::SensorCheck>(&parameters))
    return check->kind == schedules::SensorCheck::Kind::kZero;  // freed by dither before it is read
  return !std::holds_alternative<schedules::Soak>(parameters);
}

}  // namespace

CampaignRunner::MaybeEnd CampaignRunner::Reference(double expected_offset_rad) {
  const std::string missing =
      machine_.AwaitValues([this] { return CauseOf(request_.load()) != StopCause::kNone; });
  if (auto end = CheckBetweenPhases()) return end;
  if (!missing.empty()) {
    WatchChannels("referencing");
    Transition(BenchEvent::kFault);
    NoteAlarm("alarm", "referencing", "no_values", missing, Time_s());
    return CampaignEnd{CampaignEnd::Kind::kFault, {}, missing, true};
  }
  const ReferencingProgram::Tolerances tolerances{kTorqueZeroShareOfRange * bench_.transducer.range_Nm,
                                                  kEncoderOffsetTolerance_rad};
  const auto reference = [&] {
    ReferencingProgram program(tolerances, schedule_.specimen.ratio, expected_offset_rad);
    return Move(program, [&](const PhaseSnapshot&, const PhaseProgram&) { Show("referencing", share_); });
  };
  PhaseOutcome outcome = reference();
  bool unwound = false;
  while (true) {
    if (IsSuspend(outcome.reason.cause)) {
      // A campaign that was suspended, and then stopped, is resumed while its gear is warm.
      WatchChannels("referencing");
      Note("warning", "referencing", Code(outcome.reason.cause), InWords(outcome.reason));
      if (auto end = WaitUntilRecovered("referencing")) return end;
    } else if (outcome.reason.cause == StopCause::kTorqueAtRest && !unwound) {
      unwound = true;
      if (auto end = Unwind(outcome.reason.value, tolerances.torque_zero_Nm)) return end;
    } else {
      break;
    }
    outcome = reference();
  }
  WatchChannels("referencing");
  if (IsRequest(outcome.reason.cause)) return EndForRequest(outcome, "referencing");
  if (outcome.reason) return EndForFault(outcome, "referencing");
  encoder_offset_rad_ = EncoderOffset_rad(runner_.last_readings());
  Transition(BenchEvent::kReferenced);
  return std::nullopt;
}

// A drive that brakes at once, as one on Modbus does when its line falls silent, leaves the gear wound up.
CampaignRunner::MaybeEnd CampaignRunner::Unwind(double torque_Nm, double torque_zero_Nm) {
  UnwindProgram program(torque_zero_Nm);
  if (auto end = RunUncredited(program, "unwinding", BenchEvent::kBeginUnwinding)) return end;
  Note("info", "", "unwound",
       fmt::format("the gear stood wound up between its brakes with {:.1f} Nm; the load servo's brake was "
                   "released at zero torque, the transducer shows {:.1f} Nm now",
                   torque_Nm, runner_.last_readings().output_torque_Nm));
  return std::nullopt;
}

// Torque of which the journal has no phase.
CampaignRunner::MaybeEnd CampaignRunner::RunUncredited(PhaseProgram& program, std::string_view phase,
                                                       BenchEvent begin) {
  Transition(begin);
  const PhaseOutcome outcome =
      Move(program, [&](const PhaseSnapshot&, const PhaseProgram&) { Show(phase, share_); });
  if (IsFault(outcome.reason.cause)) return EndForFault(outcome, phase);
  Transition(BenchEvent::kPhaseEnded);
  if (IsRequest(outcome.reason.cause)) return EndForRequest(outcome, phase);
  return std::nullopt;
}

// On metal, before the first load of every run: between two of them people have been at the bench.
CampaignRunner::MaybeEnd CampaignRunner::CheckLoad() {
  const auto loads = [](const schedules::Phase& phase) { return AppliesLoad(phase.parameters); };
  const bool any =
      std::ranges::any_of(schedule_.preparation, loads) || std::ranges::any_of(schedule_.phases, loads);
  if (bench_.simulated || !any) return std::nullopt;
  LoadCheckProgram program(schedule_.specimen, bench_.control_period_s);
  if (auto end = RunUncredited(program, "load_check", BenchEvent::kBeginLoadRun)) return end;
  Note("info", "", "load_check",
       fmt::format(
           "load check: the transducer shows {:.3f} times the torque asked for, the input encoder {:.3f} "
           "times the speed",
           program.torque_factor(), program.speed_factor()));
  return std::nullopt;
}

// After a long pause the gear is cold. Where a measurement is next, the cycle's load run goes before it once
// more, for as long as the gear stood but no longer than the load run itself, and whole where that is not
// known. It counts as load for nobody's life but the gear's, so the journal says so.
CampaignRunner::MaybeEnd CampaignRunner::WarmUp(const Pause& pause) {
  const double pause_s = pause.length_s.value_or(std::numeric_limits<double>::infinity());
  const std::vector<CycleStep> steps = StepsOf(schedule_, resumed_cycle_);
  const auto rows = journal_.Phases(resumed_cycle_);
  const auto complete = [&](const CycleStep& step) {
    return std::ranges::any_of(
        rows, [&](const PhaseRow& row) { return row.step == step.index && row.outcome == "complete"; });
  };
  const auto next = std::ranges::find_if_not(steps, complete);
  if (pause_s <= schedule_.resume.re_soak_after_s || next == steps.end() || !next->measurement)
    return std::nullopt;
  const auto load = std::find_if(std::make_reverse_iterator(next), steps.rend(),
                                 [](const CycleStep& step) { return step.accumulates; });
  if (load == steps.rend()) return std::nullopt;
  auto run = std::get<schedules::LoadRun>(load->phase->parameters);
  run.duration_s = std::min(run.duration_s, pause_s);
  cycle_ = resumed_cycle_;
  Note("info", load->group, "warm_up",
       fmt::format("the gear stood for {}: {:.0f} s of load before the measurement, not credited",
                   pause.length_s ? fmt::format("{:.0f} s", pause_s) : "a time that is not known",
                   run.duration_s));
  const auto program = MakeProgram(run, schedule_.specimen, 0.0, bench_.control_period_s);
  if (auto end = RunUncredited(*program, "warm_up", BenchEvent::kBeginLoadRun)) return end;
  TakeMemory();
  return std::nullopt;
}

}  // namespace strainwave::bench
