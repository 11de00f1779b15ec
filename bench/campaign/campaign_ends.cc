// SPDX-License-Identifier: Apache-2.0
// How a run of a campaign ends before its time: what is said, and what is kept of a fault.
#include <algorithm>
#include <chrono>
#include <filesystem>

#include <fmt/core.h>

#include "bench/campaign/campaign_alarms.h"
#include "bench/campaign/campaign_runner.h"
#include "bench/campaign/disk_room.h"
#include "bench/campaign/sensor_stamps.h"
#include "bench/configuration/sensors_of.h"
#include "bench/spare_memory.h"
#include "daq/cycle_file.h"
#include "daq/record.h"
#include "daq/synced_folder.h"

namespace strainwave::bench {
namespace {

constexpr std::chrono::seconds kDiskInterval{1};  // by the world's clock

}  // namespace

CampaignRunner::MaybeEnd CampaignRunner::EndForRequest(const PhaseOutcome& outcome, std::string_view phase) {
  if (outcome.reason.cause == StopCause::kDiskFull) return EndForDisk(phase);
  checkpoint_.Sync();
  const std::string text = Describe(outcome.reason);
  Note("info", "", Code(outcome.reason.cause), text);
  return CampaignEnd{CampaignEnd::Kind::kInterrupted, outcome.reason, text, false};
}

std::string CampaignRunner::InWords(const StopReason& reason) const {
  const std::optional<Channel> channel = ChannelOf(reason);
  if (!channel) return Describe(reason);
  return fmt::format("{} [{}]", Describe(reason), SensorOf(*channel, bench_));
}

// A line of the journal and an alarm of it, both or none.
void CampaignRunner::NoteAlarm(std::string_view severity, std::string_view phase, std::string_view code,
                               const std::string& text, double time_s) {
  held_.DemandInPlace();
  Transaction transaction(journal_.database());
  RaiseAlarm(journal_, bench_.alarms,
             {.code = std::string(code),
              .text = text,
              .cycle = cycle_,
              .phase = std::string(phase),
              .time_s = time_s},
             Now());
  Note(severity, phase, code, text);
  transaction.Commit();
}

// In the loop's own time, which tells the first of several; the journal's, where a reason carries none.
double CampaignRunner::TimeOf_s(const StopReason& reason) const {
  const double time_s = time_base_s_ + std::chrono::duration<double>(reason.time - clock_base_).count();
  return time_s < time_base_s_ || time_s > Time_s() ? Time_s() : time_s;
}

CampaignRunner::MaybeEnd CampaignRunner::EndForFault(const PhaseOutcome& outcome, std::string_view phase) {
  Transition(BenchEvent::kFault);
  checkpoint_.Sync();
  std::string text = InWords(outcome.reason);
  if (!outcome.words.empty()) text += ": " + outcome.words;
  if (const std::string troubles = machine_.Troubles(); !troubles.empty()) text += "\n" + troubles;
  NoteAlarm("alarm", phase, Code(outcome.reason.cause), text, TimeOf_s(outcome.reason));
  for (const StopReason& followed : outcome.followed) {
    NoteAlarm("info", phase, Code(followed.cause), "followed: " + Describe(followed), TimeOf_s(followed));
  }
  held_.DemandInPlace();
  const auto file = folder_.Faults() / fmt::format("{:06d}-{:.0f}s.h5", cycle_, Time_s());
  daq::MakeFolders(folder_.Faults());
  machine_.KeepBusLogs(std::filesystem::path(file).replace_extension());
  if (!outcome.black_box.empty()) {
    machine_.TakePicture(std::filesystem::path(file).replace_extension(".jpg"));
    std::vector<NamedRecord> black_box = outcome.black_box;
    StampSensors(black_box, bench_);
    daq::WriteRecordsAtomically(file, black_box);
  }
  machine_.KeepStreams(
      std::filesystem::path(file).replace_extension(),
      {{"specimen", schedule_.specimen.identity},
       {"cycle", std::to_string(cycle_)},
       {"phase", std::string(phase)},
       {"bench", bench_.name},
       {"stop_cause", std::string(Code(outcome.reason.cause))},
       {"stop_time_s", daq::ShortestText(std::chrono::duration<double>(outcome.reason.time).count())}});
  CampaignEnd end{CampaignEnd::Kind::kFault, outcome.reason, text, IsOfADevice(outcome.reason.cause), {}};
  if (!outcome.black_box.empty()) end.black_box = file;
  return end;
}

std::optional<DiskRoom> CampaignRunner::RoomNow(int cycle) const {
  return DiskRoomOf(folder_, planned_cycle_bytes_, std::max(0, cycle - 1), schedule_.cycles);
}

// With the bench safe.
CampaignEnd CampaignRunner::EndForDisk(std::string_view phase) {
  Transition(BenchEvent::kFault);
  checkpoint_.Sync();
  const DiskRoom room = RoomToStore().value_or(DiskRoom{});
  const std::string text = fmt::format(
      "the disk is nearly full: {} are free, and what the cycle under way has recorded may take {} once more "
      "to be stored, beside {} for the journal (expected: make room, then go on)",
      BytesText(room.free_bytes), BytesText(room.record_bytes), BytesText(kReserve_bytes));
  NoteAlarm("alarm", phase, Code(StopCause::kDiskFull), text, Time_s());
  return {CampaignEnd::Kind::kFault, {}, text, true, {}};
}

CampaignRunner::MaybeEnd CampaignRunner::CheckDiskInCycle() {
  const auto room = RoomToStore();
  return room && IsTooLittleToStore(*room) ? MaybeEnd(EndForDisk("")) : std::nullopt;
}

// While something turns or waits: others write on the disk, too.
void CampaignRunner::WatchDisk() {
  const auto now = std::chrono::steady_clock::now();
  if (now - disk_looked_at_ < kDiskInterval) return;
  disk_looked_at_ = now;
  const auto room = RoomToStore();
  if (room && IsTooLittleToStore(*room)) runner_.EndForFullDisk();
}

void CampaignRunner::Watch() {
  SpareMemory::DemandKept();
  held_.WatchInPlace();
  WatchDisk();
}

HeartbeatFunction CampaignRunner::Watched(const HeartbeatFunction& then) {
  return [this, then](const PhaseSnapshot& now, const PhaseProgram& running) {
    Watch();
    ShowLive(now.readings);
    then(now, running);
  };
}

// Referencing is over before its first heartbeat.
PhaseOutcome CampaignRunner::Move(PhaseProgram& program, const HeartbeatFunction& then) {
  Watch();
  PhaseOutcome outcome = runner_.Run(program, Watched(then));
  ShowExtremes();
  return outcome;
}

// Between cycles, with torque off: a cycle that fits is begun, and no other.
CampaignRunner::MaybeEnd CampaignRunner::CheckDisk(int cycle) {
  const auto room = RoomNow(cycle);
  if (!room) return std::nullopt;
  const std::string free = BytesText(room->free_bytes);
  if (IsTooLittle(*room)) {
    cycle_ = cycle;
    Transition(BenchEvent::kFault);
    checkpoint_.Sync();
    const std::string text = fmt::format(
        "the disk is nearly full: {} are free, and the next cycle may take {} until it is stored, beside {} "
        "for the journal (expected: make room, then go on)",
        free, BytesText(room->cycle_bytes + room->record_bytes), BytesText(kReserve_bytes));
    NoteAlarm("alarm", "", Code(StopCause::kDiskFull), text, Time_s());
    return CampaignEnd{CampaignEnd::Kind::kFault, {}, text, true, {}};
  }
  if (IsLittle(*room) && !disk_fills_) {
    NoteAlarm(
        "warning", "", "disk_fills",
        fmt::format("the disk will be full before the campaign is complete, in about {:.0f} h of bench time: "
                    "{} are free, the cycles to come may take {}",
                    room->Lasts_s(one_cycle_s_) / 3600.0, free, BytesText(room->needed_bytes)),
        Time_s());
  }
  if (!IsLittle(*room) && disk_fills_) {
    Transaction transaction(journal_.database());
    ReturnAlarmsOf(journal_, "disk_fills", Time_s());
    transaction.Commit();
  }
  disk_fills_ = IsLittle(*room);
  return std::nullopt;
}

}  // namespace strainwave::bench
