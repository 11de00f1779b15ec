// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/campaign_runner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/core.h>

#include "bench/campaign/campaign_alarms.h"
#include "bench/campaign/cycle_context.h"
#include "bench/campaign/disk_room.h"
#include "bench/campaign/kept_files.h"
#include "bench/campaign/runner_settings.h"
#include "bench/campaign/sample_totals.h"
#include "bench/campaign/sensor_stamps.h"
#include "bench/controller/make_program.h"
#include "bench/sha256.h"
#include "bench/spare_memory.h"
#include "bench/utc.h"
#include "daq/cycle_file.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// How often the rows of a load run under way are written to the disk, by the world's clock.
constexpr std::chrono::seconds kKeepInterval{10};

RunnerSettings SettingsOf(const schedules::Schedule& schedule, const BenchDescription& bench) {
  RunnerSettings settings = RunnerSettingsOf(bench);
  settings.limits = schedule.limits;
  settings.suspend = schedule.suspend;
  return settings;
}

// The same for the same phase of the same cycle, however often it is run.
std::uint64_t PhaseKey(int cycle, int step, int repeat) {
  return (static_cast<std::uint64_t>(cycle) << 24) | (static_cast<std::uint64_t>(step) << 8) |
         static_cast<std::uint64_t>(repeat);
}

std::string OutcomeText(StopCause cause) {
  if (cause == StopCause::kNone) return "complete";
  if (IsSuspend(cause)) return "suspended";
  if (IsRequest(cause)) return std::string(Code(cause));
  return "fault";
}

}  // namespace

CampaignRunner::CampaignRunner(HeldFolder held, const schedules::Schedule& schedule,
                               const BenchDescription& bench, BenchMachine& machine, Journal& journal,
                               const std::atomic<StopRequest>& request, ProgressSink& progress)
    : held_(std::move(held)),
      folder_(held_.folder()),
      schedule_(schedule),
      bench_(bench),
      machine_(machine),
      journal_(journal),
      request_(request),
      progress_(progress),
      runner_(machine.Devices(), SettingsOf(schedule, bench), request),
      checkpoint_(folder_.Checkpoint()),
      live_(held_.wherever().Readings()),
      envelope_(held_.wherever().Envelope(), journal.Identity()),
      live_sources_(held_.wherever().Sources()),
      quality_(schedule, journal),
      identity_(journal.Identity()),
      schedule_sha256_(journal.Property("schedule_sha256").value_or("")),
      records_(folder_, bench, machine.Calibrations(), identity_),
      preparation_s_(PlannedDuration_s(StepsOf(schedule, 0))),
      one_cycle_s_(PlannedDuration_s(StepsOf(schedule, 1))),
      planned_cycle_bytes_(PlannedCycle_bytes(schedule)) {}

double CampaignRunner::Time_s() const {
  return time_base_s_ + std::chrono::duration<double>(machine_.Devices().clock.Now() - clock_base_).count();
}

double CampaignRunner::ShareDone(int cycle, const CycleStep& step, double share_of_step) const {
  const double before_s = cycle == 0 ? 0.0 : preparation_s_ + (cycle - 1) * one_cycle_s_;
  const double whole_s = preparation_s_ + schedule_.cycles * one_cycle_s_;
  return whole_s > 0.0 ? (before_s + step.begins_s + share_of_step * step.planned_s) / whole_s : 0.0;
}

double CampaignRunner::ShareDone(const Checkpoint& at) const {
  for (const CycleStep& step : StepsOf(schedule_, at.cycle)) {
    if (step.index != at.step) continue;
    const double served = step.planned_s > 0.0 ? std::min(1.0, at.credited_load_s / step.planned_s) : 0.0;
    return ShareDone(at.cycle, step, at.finished ? 1.0 : served);
  }
  return 0.0;
}

void CampaignRunner::Transition(BenchEvent event) {
  const auto next = Next(state_, event);
  if (!next) {
    throw std::logic_error(
        fmt::format("event {} is not allowed in state '{}'", static_cast<int>(event), Name(state_)));
  }
  state_ = *next;
}

void CampaignRunner::Note(std::string_view severity, std::string_view phase, std::string_view code,
                          const std::string& text) {
  held_.DemandInPlace();
  journal_.AddEvent(
      {Time_s(), UtcNow(), cycle_, std::string(phase), std::string(severity), std::string(code), text});
  progress_.Message(severity, text);
}

CampaignEnd CampaignRunner::Run(const ResumePoint& from) {
  double expected_offset_rad = kUnknown;
  time_base_s_ = from.time_s;
  if (from.checkpoint) {
    machine_.RestoreMemory(from.checkpoint->machine_memory);
    expected_offset_rad = from.checkpoint->encoder_offset_rad;
    resumed_cycle_ = journal_.LastCompleteCycle() + 1;
    share_ = ShareDone(*from.checkpoint);
  }
  clock_base_ = machine_.Devices().clock.Now();
  machine_.LogBuses(held_.wherever().BusLogs());
  journal_.SetChannelTroubles({});
  // The bench wakes up faulted. That the command was given is the person's reset and start; on the way the
  // references are checked with torque off.
  Transition(BenchEvent::kReset);
  Transition(BenchEvent::kStart);
  sources_ = machine_.Sources();
  if (auto end = Reference(expected_offset_rad)) return *end;
  if (!runner_.realtime_trouble().empty()) Note("warning", "", "not_realtime", runner_.realtime_trouble());
  if (auto end = CheckLoad()) return *end;
  if (from.checkpoint) {
    if (auto end = WarmUp(from.pause)) return *end;
  }
  for (int cycle = journal_.LastCompleteCycle() + 1; cycle <= schedule_.cycles; ++cycle) {
    if (auto end = CheckDisk(cycle)) return *end;
    if (auto end = RunCycle(cycle)) return *end;
  }
  Transition(BenchEvent::kFinish);
  Note("info", "", "completed", fmt::format("all {} cycles are complete", schedule_.cycles));
  return {CampaignEnd::Kind::kCompleted, {}, "complete", false};
}

CampaignRunner::MaybeEnd CampaignRunner::RunCycle(int cycle) {
  cycle_ = cycle;
  records_.Begin(cycle);
  NoteCalibrations();
  const std::vector<CycleStep> steps = StepsOf(schedule_, cycle);
  journal_.BeginCycle(cycle, Time_s());
  for (const CycleStep& step : steps) {
    if (auto end = RunStep(step, 0)) return end;
  }
  return StoreCycle(steps);
}

CampaignRunner::MaybeEnd CampaignRunner::CheckBetweenPhases() {
  SpareMemory::DemandKept();
  PhaseOutcome outcome;
  outcome.reason.cause = CauseOf(request_.load());
  if (!outcome.reason) return std::nullopt;
  return EndForRequest(outcome);
}

CampaignRunner::MaybeEnd CampaignRunner::RunStep(const CycleStep& step, int repeat) {
  if (cycle_ == resumed_cycle_) {
    const bool complete = records_.TakeFromEarlierRun(step, repeat, journal_.Phases(cycle_));
    for (const std::string& note : records_.TakeNotes()) Note("warning", step.group, "unfinished", note);
    if (complete) return std::nullopt;
  }
  if (auto end = CheckBetweenPhases()) return end;
  if (auto end = CheckDiskInCycle()) return end;
  double credited_s = 0.0;
  int attempt = 0;
  if (cycle_ == resumed_cycle_) {
    for (const PhaseRow& row : journal_.Phases(cycle_)) {
      if (row.step != step.index || row.repeat != repeat) continue;
      credited_s += row.credited_load_s;
      attempt = std::max(attempt, row.attempt);
    }
  }
  bool again = true;
  while (again) {
    if (auto end = RunAttempt(step, repeat, ++attempt, credited_s, again)) return end;
    if (!again) return std::nullopt;
    const auto rows = journal_.Phases(cycle_);
    credited_s += rows.back().credited_load_s;
    if (auto end = WaitSuspended(step.phase->name)) return end;
  }
  return std::nullopt;
}

CampaignRunner::MaybeEnd CampaignRunner::RunAttempt(const CycleStep& step, int repeat, int attempt,
                                                    double credited_before_s, bool& again) {
  const schedules::Phase& phase = *step.phase;
  const bool blank = std::holds_alternative<schedules::BlankTest>(phase.parameters);
  const bool sweep = std::holds_alternative<schedules::TransmissionErrorSweep>(phase.parameters);
  const auto program = MakeProgram(phase.parameters, schedule_.specimen, credited_before_s,
                                   sweep ? SweepPeriod_s(bench_) : bench_.control_period_s);
  PhaseRow row;
  row.cycle = cycle_;
  row.step = step.index;
  row.repeat = repeat;
  row.attempt = attempt;
  row.name = step.group;
  row.kind = schedules::KindName(phase.parameters);
  row.started_s = Time_s();
  Checkpoint at{.cycle = cycle_, .step = step.index, .repeat = repeat, .credited_load_s = credited_before_s};
  BeginRecording(step, repeat);
  // Before the journal's row: a phase that is on record has a state to go on from.
  held_.DemandInPlace();
  TakeMemory();
  WriteCheckpoint(at, runner_.last_readings(), blank);
  checkpoint_.Sync();
  const std::int64_t id = journal_.BeginPhase(row);
  if (blank) machine_.MountBlank(true);
  machine_.BeginPhase(PhaseKey(cycle_, step.index, repeat));
  Transition(BeginEvent(phase.parameters));

  auto last_kept = std::chrono::steady_clock::now();
  PhaseOutcome outcome = Move(*program, [&](const PhaseSnapshot& now, const PhaseProgram& running) {
    if (step.accumulates && std::chrono::steady_clock::now() - last_kept > kKeepInterval) {
      last_kept = std::chrono::steady_clock::now();
      held_.DemandInPlace();
      records_.WriteAhead(step, repeat, attempt, running.RecordsSoFar());
    }
    if (checkpoint_.IsDue()) {
      // A measurement that is cut is taken again from its beginning, so a simulated bench goes back there
      // too.
      if (step.accumulates) TakeMemory();
      at.credited_load_s = now.credited_load_s;
      WriteCheckpoint(at, now.readings, blank);
    }
    Show(phase.name, ShareDone(cycle_, step, now.share_done));
  });
  WatchChannels(phase.name);
  if (blank) machine_.MountBlank(false);
  JudgeSensorCheck(step, outcome);
  for (NamedRecord& recording : EndRecording(phase.name)) outcome.records.push_back(std::move(recording));

  const bool complete = !outcome.reason;
  again = IsSuspend(outcome.reason.cause);
  const bool keep = complete || step.accumulates;
  held_.DemandInPlace();
  if (keep) AddSources(outcome.records);
  if (keep) records_.Keep(step, repeat, attempt, std::move(outcome.records));
  TakeMemory();
  at.credited_load_s = outcome.credited_load_s;
  at.finished = complete;
  WriteCheckpoint(at, runner_.last_readings(), blank);
  checkpoint_.Sync();
  journal_.EndPhase(id, Time_s(), OutcomeText(outcome.reason.cause),
                    outcome.credited_load_s - credited_before_s);
  for (const std::string& note : machine_.TakeNotes()) Note("info", phase.name, "bench", note);
  if (IsFault(outcome.reason.cause)) return EndForFault(outcome, phase.name);
  if (again) {
    Note("warning", phase.name, Code(outcome.reason.cause), InWords(outcome.reason));
    Transition(BenchEvent::kSuspend);
    return std::nullopt;
  }
  Transition(BenchEvent::kPhaseEnded);
  if (!complete) return EndForRequest(outcome, phase.name);
  return std::nullopt;
}

void CampaignRunner::TakeMemory() {
  const auto memory = machine_.Memory();
  memory_.assign(memory.begin(), memory.end());
}

void CampaignRunner::WriteCheckpoint(Checkpoint checkpoint, const Readings& last, bool blank) {
  checkpoint.time_s = Time_s();
  checkpoint.written = Now();
  // Between phases alone: in one, an encoder may be stuck already and not yet be known for it.
  if (blank || checkpoint.finished) encoder_offset_rad_ = blank ? kUnknown : EncoderOffset_rad(last);
  checkpoint.encoder_offset_rad = encoder_offset_rad_;
  checkpoint.campaign = identity_;
  checkpoint.journal_end = journal_.end();
  checkpoint_.Write(checkpoint, memory_);
}

CampaignRunner::MaybeEnd CampaignRunner::WaitSuspended(std::string_view phase) {
  if (auto end = WaitUntilRecovered(phase)) return end;
  Transition(BenchEvent::kResume);
  return std::nullopt;
}

CampaignRunner::MaybeEnd CampaignRunner::WaitUntilRecovered(std::string_view phase) {
  Watch();
  const StopReason ended = runner_.WaitUntilRecovered(
      Watched([&](const PhaseSnapshot&, const PhaseProgram&) { Show(phase, share_); }));
  ShowExtremes();
  WatchChannels(phase);
  if (!ended) {
    Note("info", phase, "resumed", "the suspend condition has passed; going on");
    return std::nullopt;
  }
  PhaseOutcome outcome;
  outcome.reason = ended;
  if (IsRequest(ended.cause)) return EndForRequest(outcome, phase);
  return EndForFault(outcome, phase);
}

CampaignRunner::FileImage CampaignRunner::ImageOfCycle() const {
  FileImage image;
  if (records_.all().empty()) return image;
  image.bytes = daq::ImageOfRecords(records_.all(),
                                    {{"specimen", schedule_.specimen.identity},
                                     {"cycle", std::to_string(cycle_)},
                                     {"bench", bench_.name},
                                     {"schedule_sha256", schedule_sha256_}},
                                    folder_.CycleFile(cycle_), daq::Packing::kDeflated);
  image.sha256 = Sha256({reinterpret_cast<const char*>(image.bytes.data()), image.bytes.size()});
  return image;
}

CampaignRunner::MaybeEnd CampaignRunner::StoreCycle(const std::vector<CycleStep>& steps) {
  held_.DemandInPlace();
  machine_.CycleMeasured(cycle_);
  machine_.TakePicture(folder_.CycleFile(cycle_).replace_extension(".jpg"));
  const CycleContext context = ContextOf(journal_, schedule_, bench_);
  StoredCycle stored;
  for (int repeat = 0;; ++repeat) {
    stored = AnalyzeForStore(records_.all(), cycle_, context);
    if (cycle_ == 0 || repeat == schedule_.measurements.retries) break;
    std::vector<std::string> warnings = stored.failed_checks;
    for (std::string& outlier : quality_.Outliers(stored.results)) warnings.push_back(std::move(outlier));
    if (warnings.empty()) break;
    for (const std::string& warning : warnings) {
      Note("warning", "", "measured_again", fmt::format("cycle {}: {}; measuring again", cycle_, warning));
    }
    for (const CycleStep& step : steps) {
      if (!step.measurement) continue;
      if (auto end = RunStep(step, repeat + 1)) return end;
    }
  }
  Transition(BenchEvent::kBeginStore);
  for (const std::string& check : stored.failed_checks) {
    Note("warning", "", "failed_check", fmt::format("cycle {}: {}", cycle_, check));
  }
  // Not beside the analysis: HDF5 crashes where it gets no memory, and another thread may take what was asked
  // for.
  const FileImage image = ImageOfCycle();
  held_.DemandInPlace();
  // Where nothing is prepared there is nothing to keep.
  if (!image.bytes.empty()) daq::WriteFileAtomically(folder_.CycleFile(cycle_), image.bytes);
  held_.DemandInPlace();
  const std::vector<KeptFile> kept = FilesOfCycle(folder_, cycle_);
  {
    Transaction transaction(journal_.database());
    journal_.ClearResults(cycle_);
    journal_.AddResults(cycle_, 0, stored.results);
    for (std::size_t i = 0; i < stored.repeats.size(); ++i) {
      journal_.AddResults(cycle_, static_cast<int>(i) + 1, stored.repeats[i]);
    }
    for (const Calibration& calibration : stored.calibrations) journal_.SetCalibration(calibration, UtcNow());
    journal_.EndCycle(cycle_, Time_s(), "complete", image.sha256);
    for (const KeptFile& file : kept) journal_.AddFile(file.path, file.digest);
    KeepSampleTotals(journal_);
    transaction.Commit();
  }
  held_.DemandInPlace();
  records_.RemoveUnfinished();
  Transition(BenchEvent::kStored);
  quality_.TakeGauge(journal_);
  quality_.Accept(cycle_, stored.results);
  progress_.CycleStored(cycle_, stored.results);
  if (!stored.failed_checks.empty() &&
      schedule_.measurements.on_failed_check == schedules::OnFailedCheck::kStop) {
    const std::string text = fmt::format("cycle {}: {}", cycle_, stored.failed_checks.front());
    return CampaignEnd{CampaignEnd::Kind::kStopCriterion, {}, text, false};
  }
  return cycle_ == 0 ? std::nullopt : AfterCycle(stored.results);
}

CampaignRunner::MaybeEnd CampaignRunner::AfterCycle(const std::vector<Result>& results) {
  if (const auto met = quality_.StopCriterion(results)) {
    NoteAlarm("alarm", "", kStopCriterionAlarm, *met, Time_s());
    // Nothing lasts that could return later.
    Transaction transaction(journal_.database());
    ReturnAlarmsOf(journal_, kStopCriterionAlarm, Time_s());
    transaction.Commit();
    return CampaignEnd{CampaignEnd::Kind::kStopCriterion, {}, *met, false};
  }
  if (request_.load() != StopRequest::kFinishCycle || cycle_ == schedule_.cycles) return std::nullopt;
  Note("info", "", "finish_cycle", "cycle finished, stopped on request");
  return CampaignEnd{CampaignEnd::Kind::kInterrupted, {}, "cycle finished, stopped on request", false};
}

}  // namespace strainwave::bench
