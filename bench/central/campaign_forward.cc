// SPDX-License-Identifier: Apache-2.0
#include "bench/central/campaign_forward.h"

#include <cstdlib>
#include <fstream>
#include <utility>

#include <fmt/core.h>

#include "bench/campaign/campaign.h"
#include "bench/central/server_columns.h"
#include "bench/page/campaign_watch.h"
#include "bench/sha256.h"

namespace strainwave::bench {
namespace {

constexpr std::int64_t kSignOfLifeEvery_ms = 300'000;

// What may change is known by these names.
std::string NameOfSent(const SentCycle& cycle) { return fmt::format("cycles {}", cycle.cycle); }
std::string NameOfSent(const SentAlarm& alarm) { return fmt::format("alarms {}", alarm.instance.number); }
std::string NameOfSent(const SentRow& row) { return fmt::format("{} {}", row.table, row.key); }
std::string TextOfSent(const SentCycle& cycle) { return cycle.outcome + cycle.phases; }
std::string TextOfSent(const SentAlarm& alarm) { return alarm.row; }
std::string TextOfSent(const SentRow& row) { return row.row; }

SentState StateOf(const CampaignSnapshot& snapshot, const Journal& journal) {
  const CampaignProgress& progress = snapshot.progress;
  SentState state{std::string(NameOf(snapshot.view)),
                  progress.phase,
                  progress.cycle,
                  progress.cycles,
                  progress.complete,
                  static_cast<int>(progress.open_alarms.size()),
                  {},
                  {}};
  const std::vector<AlarmInstance> alarms = journal.Alarms(-1.0);
  if (alarms.empty()) return state;
  state.last_alarm = ServerText(alarms.back().text);
  state.last_alarm_utc = ServerText(alarms.back().raised_utc);
  return state;
}

bool IsBehind(const JournalMarks& now, const JournalMarks& before) {
  if (now.cycle < before.cycle) return true;
  for (const auto& [table, number] : before.table) {
    const auto found = now.table.find(table);
    if (found == now.table.end() || found->second < number) return true;
  }
  return false;
}

}  // namespace

std::string MachineId(const std::filesystem::path& file) {
  std::string id;
  std::ifstream(file) >> id;
  if (id.empty()) Refuse(file, "has no id of this machine", "one, as systemd-machine-id-setup makes it");
  return Sha256("strainwave central " + id).substr(0, 32);
}

CampaignForward::CampaignForward(const CampaignFolder& folder, ForwardSettings settings)
    : folder_(folder), settings_(std::move(settings)) {
  if (!settings_.store.empty()) store_.emplace(settings_.store);
}

Forwarded CampaignForward::Look(ServerSource& source) {
  const CampaignSnapshot snapshot = CampaignWatch(folder_).Look().snapshot;
  const Journal journal = OpenCampaign(folder_, Database::Mode::kReadOnly, PagesChecked::kAsRead);
  if (connection_ == 0) Connect(source, journal);
  Forwarded done;
  for (bool is_last = false; !is_last;) {
    JournalBatch batch = ReadBatch(journal, marks_, settings_.cycles_per_batch);
    is_last = batch.is_last;
    LeaveOutSent(batch);
    if (batch.IsEmpty()) break;
    if (Connect(source, journal)) {
      is_last = false;
      continue;
    }
    done.rows += sender_.Send(source.Get(), batch);
    for (const SentCycle& cycle : batch.cycles) done.cycles += cycle.outcome == "complete" ? 1 : 0;
    TakeAsSent(batch);
  }
  TellState(source, StateOf(snapshot, journal), journal);
  if (store_) KeepRecords(source, journal, done);
  done.bench = sender_.bench();
  done.clock_off_s = sender_.clock_off_s();
  return done;
}

bool CampaignForward::Connect(ServerSource& source, const Journal& journal) {
  Server& server = source.Get();
  if (source.number() == connection_) return false;
  sender_.Begin(server, settings_.machine,
                {fmt::format("{:016x}", journal.Identity()), journal.Property("schedule_name").value_or(""),
                 journal.Property("specimen").value_or(""), journal.Property("started_utc").value_or("")},
                settings_.utc_ms());
  for (const FrozenFile& frozen : FrozenFiles(folder_)) {
    // The first connection alone: they never change.
    if (connection_ == 0 && std::filesystem::exists(frozen.file))
      sender_.KeepInput(server, ReadText(frozen.file));
  }
  const JournalMarks marks = sender_.Marks(server);
  // A server that was set back, to a copy of earlier, lacks more than what only grows.
  if (connection_ == 0 || IsBehind(marks, marks_)) changing_.clear();
  marks_ = marks;
  if (store_) kept_records_ = sender_.Records(server);
  connection_ = source.number();
  return true;
}

void CampaignForward::LeaveOutSent(JournalBatch& batch) const {
  const auto is_sent = [this](const auto& one) {
    const auto found = changing_.find(NameOfSent(one));
    return found != changing_.end() && found->second == TextOfSent(one);
  };
  std::erase_if(batch.cycles,
                [&](const SentCycle& cycle) { return cycle.outcome != "complete" && is_sent(cycle); });
  std::erase_if(batch.alarms, is_sent);
  std::erase_if(batch.rows, [&](const SentRow& row) { return row.number == 0 && is_sent(row); });
}

void CampaignForward::TakeAsSent(const JournalBatch& batch) {
  for (const SentCycle& cycle : batch.cycles) {
    if (cycle.outcome == "complete") {
      marks_.cycle = cycle.cycle;
      changing_.erase(NameOfSent(cycle));
    } else {
      changing_[NameOfSent(cycle)] = TextOfSent(cycle);
    }
  }
  for (const SentAlarm& alarm : batch.alarms) changing_[NameOfSent(alarm)] = TextOfSent(alarm);
  for (const SentRow& row : batch.rows) {
    if (row.number > 0) {
      marks_.table[row.table] = row.number;
    } else {
      changing_[NameOfSent(row)] = TextOfSent(row);
    }
  }
}

void CampaignForward::TellState(ServerSource& source, const SentState& state, const Journal& journal) {
  const std::int64_t now_ms = settings_.utc_ms();
  // A clock may have been set back meanwhile.
  if (state_ && *state_ == state && std::abs(now_ms - state_sent_ms_) < kSignOfLifeEvery_ms) return;
  Connect(source, journal);
  sender_.SendState(source.Get(), state, now_ms);
  state_ = state;
  state_sent_ms_ = now_ms;
}

void CampaignForward::KeepRecords(ServerSource& source, const Journal& journal, Forwarded& done) {
  const auto keep = [&](const std::string& path, const std::string& sha256) {
    const std::filesystem::path file = folder_.root / path;
    const std::string name = path + ' ' + sha256;
    if (done_.contains(name)) return;
    std::error_code missing;
    const std::uintmax_t bytes = std::filesystem::file_size(file, missing);
    const bool is_known = kept_records_.contains(name);
    // Of a record that was forwarded before the file may be gone here; the store may be another one, too.
    if (missing && is_known) return;
    if (missing || !store_->Keep(file, sha256)) {
      done_.insert(name);
      done.troubles.push_back(fmt::format("{}: {}: not kept in the store", file.string(),
                                          missing ? "is missing" : "is not what the journal says of it"));
      return;
    }
    if (!is_known) {
      Connect(source, journal);
      sender_.SendRecord(source.Get(), path, sha256, bytes);
      ++done.records;
    }
    done_.insert(name);
  };
  JournalFileMarks marks = looked_at_;
  for (const JournalFile& file : FilesAfter(journal.database(), marks)) keep(file.path, file.sha256);
  looked_at_ = marks;
  done_.clear();
}

}  // namespace strainwave::bench
