// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/phase_runner.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <thread>
#include <utility>

#include "analysis/units.h"
#include "bench/controller/standstill_programs.h"
#include "bench/realtime/latest.h"
#include "bench/realtime/realtime.h"
#include "bench/seconds.h"

namespace strainwave::bench {
namespace {

using std::chrono::duration;
using std::chrono::nanoseconds;

constexpr double kHistory_s = 10.0;
constexpr double kAfterStop_s = 1.0;
constexpr int kHistoryChannels = 9;
constexpr double kHeartbeat_s = 1.0;
// Beats that may wait for a thread that is held up; further ones are one with the last.
constexpr std::size_t kBeatsWaiting = 64;

// The stop comes on every way out of a phase, also by an exception.
class SafeOnExit {
 public:
  explicit SafeOnExit(PhaseRunner& runner) : runner_(runner) {}
  SafeOnExit(const SafeOnExit&) = delete;
  SafeOnExit& operator=(const SafeOnExit&) = delete;
  ~SafeOnExit() { runner_.MakeSafe(); }

 private:
  PhaseRunner& runner_;
};

}  // namespace

StopCause CauseOf(StopRequest request) {
  switch (request) {
    case StopRequest::kPause:
      return StopCause::kPauseRequested;
    case StopRequest::kShutdown:
      return StopCause::kShutdownRequested;
    case StopRequest::kQuickStop:
      return StopCause::kQuickStopRequested;
    case StopRequest::kNone:
    case StopRequest::kFinishCycle:  // the campaign looks at it after the cycle
      return StopCause::kNone;
  }
  return StopCause::kNone;
}

PhaseRunner::PhaseRunner(BenchDevices devices, const RunnerSettings& settings,
                         const std::atomic<StopRequest>& request)
    : driving_(devices.driving, BenchServo::kDriving),
      load_(devices.load, BenchServo::kLoad),
      devices_{driving_, load_, devices.sampler, devices.clock},
      settings_(settings),
      interlocks_(settings.limits, Nanoseconds(settings.stale_after_s)),
      suspend_(settings.suspend),
      shaft_(settings.input_encoder_step_rad),
      request_(request),
      history_(static_cast<std::size_t>(kHistory_s / settings.control_period_s), kHistoryChannels),
      handed_over_(kBeatsWaiting, {}) {
  // Power-up: nothing may turn before a person has started the bench (docs/requirements.md R12).
  MakeSafe();
}

void PhaseRunner::MakeSafe() noexcept {
  devices_.driving.QuickStop();
  devices_.load.QuickStop();
  devices_.sampler.ConnectShunt(false);
}

InterlockInputs PhaseRunner::Inputs(const PhaseProgram& program) const noexcept {
  InterlockInputs inputs;
  inputs.driving = devices_.driving.Actual();
  inputs.load = devices_.load.Actual();
  inputs.now = devices_.clock.Now();
  inputs.input_locked = program.input_locked();
  if (inputs.input_locked) inputs.twist_rad = readings_.output_angle_rad - program.locked_output_angle_rad();
  return inputs;
}

StopReason PhaseRunner::SoftRequest() const noexcept {
  StopCause cause = CauseOf(request_.load(std::memory_order_relaxed));
  // A pause may wait for a measurement, a disk does not.
  if (disk_full_.load(std::memory_order_relaxed) && cause != StopCause::kShutdownRequested) {
    cause = StopCause::kDiskFull;
  }
  // A quick stop is never soft; it has been looked at with the limits.
  if (cause == StopCause::kNone || cause == StopCause::kQuickStopRequested) return {};
  return {cause, 0.0, 0.0, readings_.time};
}

void PhaseRunner::AddToHistory(const Readings& readings) noexcept {
  const std::array<double, kHistoryChannels> row{duration<double>(readings.time).count(),
                                                 DegFromRad(readings.input_angle_rad),
                                                 DegFromRad(readings.output_angle_rad),
                                                 RpmFromRadPerS(readings.input_speed_rad_per_s),
                                                 readings.output_torque_Nm,
                                                 readings.motor_torque_Nm,
                                                 readings.gear_temperature_degC,
                                                 readings.ambient_temperature_degC,
                                                 readings.vibration_rms_m_per_s2};
  history_.Push(row);
  extremes_.Add(readings);
}

// Where nobody has taken what came before, it waits with what is still to come.
void PhaseRunner::HandOverExtremes() noexcept {
  LiveExtremes* const slot = handed_over_.BeginWrite();
  if (slot == nullptr) return;
  *slot = extremes_;
  handed_over_.EndWrite();
  extremes_ = {};
}

LiveExtremes PhaseRunner::TakeExtremes() noexcept {
  LiveExtremes all = std::exchange(waiting_extremes_, {});
  while (const LiveExtremes* const next = handed_over_.BeginRead()) {
    all.Merge(*next);
    handed_over_.EndRead();
  }
  return all;
}

StopReason PhaseRunner::OnePeriod(PhaseProgram& program, double elapsed_s, double period_s) noexcept {
  readings_ = devices_.sampler.Read();
  AddToHistory(readings_);
  const InterlockInputs inputs = Inputs(program);
  const StopReason broken = interlocks_.Check(readings_, inputs);
  // Some readings are a drive's: where they are missing because the drive is, that is the reason.
  const bool may_be_drives =
      broken.cause == StopCause::kStaleReadings || broken.cause == StopCause::kImplausibleReading;
  if (broken && !may_be_drives) return broken;
  const nanoseconds stale_after = Nanoseconds(settings_.stale_after_s);
  if (const StopReason gone = driving_.Check(inputs.driving, inputs.now, stale_after)) return gone;
  if (const StopReason gone = load_.Check(inputs.load, inputs.now, stale_after)) return gone;
  if (broken) return broken;
  if (const StopReason apart = shaft_.Check(readings_, inputs.driving)) return apart;
  if (request_.load(std::memory_order_relaxed) == StopRequest::kQuickStop ||
      abandoned_.load(std::memory_order_relaxed)) {
    return {StopCause::kQuickStopRequested, 0.0, 0.0, readings_.time};
  }
  if (const StopReason suspended = suspend_.Check(readings_, period_s)) return suspended;
  if (elapsed_s > program.timeout_s()) {
    return {StopCause::kPhaseTimeout, elapsed_s, program.timeout_s(), readings_.time};
  }
  return {};
}

PhaseOutcome PhaseRunner::Run(PhaseProgram& program, const HeartbeatFunction& heartbeat) {
  PhaseOutcome outcome;
  outcome.reason = settings_.own_thread
                       ? LoopOnItsOwnThread(program, heartbeat)
                       : Loop(program, [&](const PhaseSnapshot& snapshot) { heartbeat(snapshot, program); });
  outcome.credited_load_s = program.credited_load_s();
  if (IsFault(outcome.reason.cause)) AfterFault(program, outcome);
  // The loop is over: nobody else adds to them.
  waiting_extremes_ = TakeExtremes();
  waiting_extremes_.Merge(extremes_);
  extremes_ = {};
  program.Collect(devices_);
  outcome.records = program.TakeRecords();
  return outcome;
}

StopReason PhaseRunner::LoopOnItsOwnThread(PhaseProgram& program, const HeartbeatFunction& heartbeat) {
  constexpr std::uint32_t kEnded = std::numeric_limits<std::uint32_t>::max();
  Latest<PhaseSnapshot> latest;
  std::atomic<std::uint32_t> beats{};
  StopReason reason;
  std::exception_ptr failure;
  abandoned_ = false;
  std::thread thread([&] {
    realtime_trouble_ = BecomeRealtime(RealtimeRank::kControl);
    try {
      reason = Loop(program, [&](const PhaseSnapshot& snapshot) {
        latest.Set(snapshot);
        ++beats;
        beats.notify_one();
      });
    } catch (...) {
      failure = std::current_exception();
    }
    beats = kEnded;
    beats.notify_one();
  });
  try {
    std::uint32_t seen = 0;
    while (seen != kEnded) {
      beats.wait(seen);
      seen = beats;
      if (seen != kEnded) heartbeat(latest.Get(), program);
    }
  } catch (...) {
    abandoned_ = true;
    thread.join();
    throw;
  }
  thread.join();
  if (failure) std::rethrow_exception(failure);
  return reason;
}

StopReason PhaseRunner::Loop(PhaseProgram& program, const Beat& beat) {
  const double period_s = std::min(settings_.control_period_s, program.control_period_s());
  const nanoseconds period = Nanoseconds(period_s);
  const SafeOnExit safe(*this);
  const nanoseconds start = devices_.clock.Now();
  nanoseconds next = start;
  nanoseconds next_beat = start + Nanoseconds(kHeartbeat_s);
  readings_ = devices_.sampler.Read();
  shaft_.Restart();
  driving_.Restart(start);
  load_.Restart(start);
  bool set_up = false;
  StopReason winding_down;
  while (true) {
    const double elapsed_s = duration<double>(next - start).count();
    if (const StopReason broken = OnePeriod(program, elapsed_s, period_s)) return broken;
    if (!set_up) {
      program.SetUp(readings_, devices_);
      set_up = true;
    }
    if (!winding_down) {
      winding_down = SoftRequest();
      const bool by_itself = winding_down && program.WindDown();
      const bool at_once = winding_down && winding_down.cause != StopCause::kPauseRequested;
      if (!by_itself && at_once) return winding_down;
      // A pause waits for the end of a phase that cannot be cut.
      if (!by_itself) winding_down = {};
    }
    const StepResult result = program.Step(readings_, elapsed_s, devices_);
    if (result == StepResult::kDone) return winding_down;
    if (result == StepResult::kFailedCheck) return program.failed_check();
    if (result == StepResult::kLogFull) return {StopCause::kLogFull, 0.0, 0.0, readings_.time};
    program.Collect(devices_);
    if (next >= next_beat) {
      next_beat += Nanoseconds(kHeartbeat_s);
      HandOverExtremes();
      beat({program.share_done(), program.credited_load_s(), readings_});
    }
    next += period;
    devices_.clock.SleepUntil(next);
  }
}

void PhaseRunner::AfterFault(PhaseProgram& program, PhaseOutcome& outcome) {
  devices_.sampler.MarkTrip();
  const nanoseconds period = Nanoseconds(settings_.control_period_s);
  const auto rows = static_cast<int>(kAfterStop_s / settings_.control_period_s);
  for (int row = 0; row < rows; ++row) {
    devices_.clock.SleepUntil(devices_.clock.Now() + period);
    readings_ = devices_.sampler.Read();
    AddToHistory(readings_);
    std::array<StopReason, 12> broken;
    const std::size_t count = interlocks_.CheckAll(readings_, Inputs(program), broken);
    for (std::size_t i = 0; i < count; ++i) {
      const auto same = [&](const StopReason& known) { return known.cause == broken[i].cause; };
      if (same(outcome.reason) || std::ranges::any_of(outcome.followed, same)) continue;
      outcome.followed.push_back(broken[i]);
    }
  }
  std::vector<std::vector<double>> kept = history_.Unroll();
  constexpr std::array<const char*, kHistoryChannels> kNames{"time_s",
                                                             "input_angle_deg",
                                                             "output_angle_deg",
                                                             "input_speed_rpm",
                                                             "torque_Nm",
                                                             "motor_torque_Nm",
                                                             "gear_temperature_degC",
                                                             "ambient_temperature_degC",
                                                             "vibration_rms_m_per_s2"};
  NamedRecord box{"black_box", {}};
  box.record.kind = daq::RecordKind::kHistory;
  box.record.SetMetadata("stop_time_s", duration<double>(outcome.reason.time).count());
  box.record.SetMetadata("stop_cause", std::string(Code(outcome.reason.cause)));
  for (std::size_t channel = 0; channel < kNames.size(); ++channel) {
    box.record.columns.push_back({kNames[channel], std::move(kept[channel]), {}, {}});
  }
  outcome.black_box.push_back(std::move(box));
}

StopReason PhaseRunner::WaitUntilRecovered(const HeartbeatFunction& heartbeat) {
  MakeSafe();
  const double period_s = settings_.control_period_s;
  double waited_s = 0.0;
  double since_heartbeat_s = 0.0;
  const SoakProgram standstill({});
  while (true) {
    devices_.clock.SleepUntil(devices_.clock.Now() + Nanoseconds(period_s));
    waited_s += period_s;
    readings_ = devices_.sampler.Read();
    AddToHistory(readings_);
    if (request_.load(std::memory_order_relaxed) == StopRequest::kQuickStop) {
      return {StopCause::kQuickStopRequested, 0.0, 0.0, readings_.time};
    }
    if (const StopReason asked = SoftRequest()) return asked;
    if (suspend_.Recovered(readings_, period_s)) return {};
    if (waited_s > settings_.suspend.give_up_s) {
      if (readings_.bad_channels == 0) {
        return {StopCause::kDidNotCool, waited_s, settings_.suspend.resume_temperature_degC, readings_.time};
      }
      return {StopCause::kSensorStayedBad, static_cast<double>(std::countr_zero(readings_.bad_channels)),
              waited_s, readings_.time};
    }
    since_heartbeat_s += period_s;
    if (since_heartbeat_s >= kHeartbeat_s) {
      since_heartbeat_s = 0.0;
      HandOverExtremes();
      heartbeat({0.0, 0.0, readings_}, standstill);
    }
  }
}

}  // namespace strainwave::bench
