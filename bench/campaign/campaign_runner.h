// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/campaign/checkpoint.h"
#include "bench/campaign/cycle_records.h"
#include "bench/campaign/cycle_results.h"
#include "bench/campaign/cycle_steps.h"
#include "bench/campaign/disk_room.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/held_folder.h"
#include "bench/campaign/journal.h"
#include "bench/campaign/live_envelope.h"
#include "bench/campaign/live_readings.h"
#include "bench/campaign/live_sources.h"
#include "bench/campaign/progress.h"
#include "bench/campaign/quality.h"
#include "bench/campaign/resume_point.h"
#include "bench/configuration/bench_description.h"
#include "bench/controller/phase_runner.h"
#include "bench/roles/bench_machine.h"
#include "bench/safety/state_machine.h"

namespace strainwave::bench {

/// How a run of a campaign ended.
struct CampaignEnd {
  enum class Kind { kCompleted, kStopCriterion, kFault, kInterrupted };
  Kind kind{Kind::kCompleted};
  StopReason reason;  // fault or request
  std::string text;   // for people
  bool device_failed{};
  std::filesystem::path black_box{};  // of a fault: the channels before it; empty where nothing had moved
};

/// Runs the cycles of a campaign on a bench: one state machine, one step after the other, each journalled
/// before it starts and after it has ended, so that whatever happens the next run knows where to go on.
class CampaignRunner {
 public:
  CampaignRunner(HeldFolder held, const schedules::Schedule& schedule, const BenchDescription& bench,
                 BenchMachine& machine, Journal& journal, const std::atomic<StopRequest>& request,
                 ProgressSink& progress);

  /// @throws BenchError, with the bench safe, when another folder has come in the place of the campaign's.
  CampaignEnd Run(const ResumePoint& from);

 private:
  using MaybeEnd = std::optional<CampaignEnd>;

  /// Of a cycle's file; nothing where there are no records.
  struct FileImage {
    std::vector<std::byte> bytes;
    std::string sha256;
  };

  void Transition(BenchEvent event);
  MaybeEnd Reference(double expected_offset_rad);
  MaybeEnd Unwind(double torque_Nm, double torque_zero_Nm);
  MaybeEnd RunUncredited(PhaseProgram& program, std::string_view phase, BenchEvent begin);
  /// What every motion and every wait looks at before it begins and once a second: memory and folder, which
  /// end it by an exception, and the disk, which ends it in words.
  void Watch();
  /// A motion of whatever kind, watched. `then` comes with each heartbeat, after the watch.
  PhaseOutcome Move(PhaseProgram& program, const HeartbeatFunction& then);
  HeartbeatFunction Watched(const HeartbeatFunction& then);
  MaybeEnd CheckLoad();
  MaybeEnd CheckDisk(int cycle);
  MaybeEnd CheckDiskInCycle();
  void WatchDisk();
  std::optional<DiskRoom> RoomNow(int cycle) const;
  /// For the cycle under way, or the one that a run goes on with.
  std::optional<DiskRoom> RoomToStore() const { return RoomNow(std::max(cycle_, resumed_cycle_)); }
  CampaignEnd EndForDisk(std::string_view phase);
  MaybeEnd WarmUp(const Pause& pause);
  MaybeEnd RunCycle(int cycle);
  MaybeEnd RunStep(const CycleStep& step, int repeat);
  MaybeEnd RunAttempt(const CycleStep& step, int repeat, int attempt, double credited_before_s, bool& again);
  FileImage ImageOfCycle() const;
  MaybeEnd StoreCycle(const std::vector<CycleStep>& steps);
  MaybeEnd EndForRequest(const PhaseOutcome& outcome, std::string_view phase = "");
  MaybeEnd EndForFault(const PhaseOutcome& outcome, std::string_view phase);
  std::string InWords(const StopReason& reason) const;  // with the sensor that showed it
  MaybeEnd WaitSuspended(std::string_view phase);
  MaybeEnd WaitUntilRecovered(std::string_view phase);
  MaybeEnd AfterCycle(const std::vector<Result>& results);
  MaybeEnd CheckBetweenPhases();

  void NoteCalibrations();
  void WatchChannels(std::string_view phase);
  void Show(std::string_view phase, double share);
  /// To other processes: readings, their extremes since the last call, and what came of the sources.
  void ShowLive(const Readings& readings);
  /// The same at the end of a phase, whose last readings no heartbeat has shown.
  void ShowExtremes();
  void BeginRecording(const CycleStep& step, int repeat);
  std::vector<NamedRecord> EndRecording(std::string_view phase);
  void AddSources(std::vector<NamedRecord>& records);
  void JudgeSensorCheck(const CycleStep& step, PhaseOutcome& outcome);
  void TakeMemory();
  void WriteCheckpoint(Checkpoint checkpoint, const Readings& last, bool blank);
  double EncoderOffset_rad(const Readings& readings) const {
    return readings.input_angle_rad / schedule_.specimen.ratio - readings.output_angle_rad;
  }
  void Note(std::string_view severity, std::string_view phase, std::string_view code,
            const std::string& text);
  void NoteAlarm(std::string_view severity, std::string_view phase, std::string_view code,
                 const std::string& text, double time_s);
  double TimeOf_s(const StopReason& reason) const;
  double Time_s() const;
  /// Share of the campaign that is done when this share of a step is; by planned time.
  double ShareDone(int cycle, const CycleStep& step, double share_of_step) const;
  double ShareDone(const Checkpoint& at) const;

  HeldFolder held_;
  CampaignFolder folder_;
  const schedules::Schedule& schedule_;
  const BenchDescription& bench_;
  BenchMachine& machine_;
  Journal& journal_;
  const std::atomic<StopRequest>& request_;
  ProgressSink& progress_;
  PhaseRunner runner_;
  CheckpointWriter checkpoint_;
  LiveReadingsFile live_;
  LiveEnvelopeFile envelope_;
  LiveSourcesFile live_sources_;
  QualityControl quality_;
  BenchState state_{BenchState::kFaulted};
  double encoder_offset_rad_{};  // of the shafts against each other, at the last end of a phase
  double time_base_s_{};         // bench time of earlier runs
  std::chrono::nanoseconds clock_base_{};
  std::uint64_t identity_;  // of the campaign
  std::string schedule_sha256_;
  CycleRecords records_;
  std::vector<SourceTotals> sources_;  // as the last records that were kept have left them
  double preparation_s_{};             // planned
  double one_cycle_s_{};               // planned
  double planned_cycle_bytes_{};
  bool disk_fills_{};  // an alarm says so
  std::chrono::steady_clock::time_point disk_looked_at_{};
  int cycle_{};
  int resumed_cycle_{-1};
  double share_{};                                // done, as last shown
  std::vector<ChannelTrouble> channel_troubles_;  // as the journal has them
  std::set<std::string> noted_channels_;          // whose calibration does not hold
  std::vector<std::byte> memory_;                 // of a simulated bench, as the next checkpoint will hold it
};

}  // namespace strainwave::bench
