// SPDX-License-Identifier: Apache-2.0
#include "bench/central/campaign_forward.h"

#include <cmath>
#include <fstream>
#include <utility>

#include <fmt/core.h>

#include "bench/campaign/campaign.h"
#include "bench/central/copy_text.h"
#include "bench/page/campaign_watch.h"
#include "bench/sha256.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

constexpr std::int64_t kStateAtLeastEvery_ms = 30'000;

// Of this connection, emptied by every commit.
constexpr const char* kSentTables = R"sql(
CREATE TEMP TABLE IF NOT EXISTS sent_cycles(cycle integer, outcome text, started_s double precision,
  ended_s double precision, records_sha256 text, phases json) ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS sent_results(cycle integer, repeat smallint, quantity_set integer,
  result_values double precision[], standard_errors double precision[], flags text[]) ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS sent_alarms(number bigint, code text, alarm_text text, priority text, state text,
  cycle integer, raised_utc text, returned_utc text, acknowledged_by text, journal_row json) ON COMMIT DELETE ROWS;
CREATE TEMP TABLE IF NOT EXISTS sent_rows(journal_table strainwave.journal_table, number bigint, key text,
  journal_row json) ON COMMIT DELETE ROWS;
)sql";

// What may change is known by these names.
std::string NameOfSent(const SentCycle& cycle) { return fmt::format("cycles {}", cycle.cycle); }
std::string NameOfSent(const SentAlarm& alarm) { return fmt::format("alarms {}", alarm.instance.number); }
std::string NameOfSent(const SentRow& row) { return fmt::format("{} {}", row.table, row.key); }
std::string TextOfSent(const SentCycle& cycle) { return cycle.outcome + cycle.phases; }
std::string TextOfSent(const SentAlarm& alarm) { return alarm.row; }
std::string TextOfSent(const SentRow& row) { return row.row; }

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

Forwarded CampaignForward::Look(Server& server, bool is_new) {
  const CampaignSnapshot snapshot = CampaignWatch(folder_).Look().snapshot;
  const Journal journal = OpenCampaign(folder_, Database::Mode::kReadOnly, PagesChecked::kAsRead);
  if (is_new) Begin(server, journal);
  Forwarded done;
  done.bench = place_.bench;
  for (bool is_last = false; !is_last;) {
    JournalBatch batch = ReadBatch(journal, marks_, settings_.cycles_per_batch);
    is_last = batch.is_last;
    LeaveOutSent(batch);
    if (batch.IsEmpty()) break;
    done.rows += Send(server, batch);
    for (const SentCycle& cycle : batch.cycles) done.cycles += cycle.outcome == "complete" ? 1 : 0;
    Remember(batch);
  }
  SendState(server, snapshot, journal);
  if (store_) KeepRecords(server, journal, done);
  done.clock_off_s = clock_off_s_;
  return done;
}

void CampaignForward::Begin(Server& server, const Journal& journal) {
  server.Execute(kSentTables);
  MeasureClock(server);
  const ServerRows place = server.Run(
      "SELECT * FROM strainwave.register_campaign($1, $2, $3, $4, $5)",
      {settings_.machine, fmt::format("{:016x}", journal.Identity()),
       ServerText(journal.Property("schedule_name").value_or("")),
       ServerText(journal.Property("specimen").value_or("")), ServerText(journal.Property("started_utc").value_or(""))});
  place_ = {place.Text(0, 0), place.Text(0, 1), place.Text(0, 2), place.Text(0, 3)};
  for (const FrozenFile& frozen : FrozenFiles(folder_)) {
    if (!std::filesystem::exists(frozen.file)) continue;
    std::string bytes = "\\x";
    for (const char byte : ReadText(frozen.file)) bytes += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    server.Run("SELECT strainwave.keep_input($1::bytea)", {bytes});
  }
  marks_ = {};
  changing_.clear();
  quantity_sets_.clear();
  kept_records_.clear();
  state_.clear();
  constexpr const char* kOfCampaign = "WHERE month = $1 AND bench_id = $2 AND campaign_id = $3";
  const std::vector<ServerValue> here = PlaceAnd({});
  marks_.cycle = static_cast<int>(
      server
          .Run(fmt::format("SELECT coalesce(max(cycle) FILTER (WHERE outcome = 'complete'), -1) FROM "
                           "strainwave.cycles {}",
                           kOfCampaign),
               here)
          .Integer(0, 0));
  const ServerRows tables = server.Run(
      fmt::format("SELECT journal_table, max(number) FROM strainwave.journal_rows {} GROUP BY 1", kOfCampaign), here);
  for (int i = 0; i < tables.count(); ++i) marks_.table[tables.Text(i, 0)] = tables.Integer(i, 1);
  if (!store_) return;
  const ServerRows records =
      server.Run(fmt::format("SELECT path, sha256 FROM strainwave.records {}", kOfCampaign), here);
  for (int i = 0; i < records.count(); ++i) kept_records_.insert(records.Text(i, 0) + ' ' + records.Text(i, 1));
}

std::vector<ServerValue> CampaignForward::PlaceAnd(std::initializer_list<ServerValue> more) const {
  std::vector<ServerValue> values{place_.month, place_.bench_id, place_.campaign_id};
  values.insert(values.end(), more.begin(), more.end());
  return values;
}

void CampaignForward::MeasureClock(Server& server) {
  const ServerRows clock = server.Run("SELECT extract(epoch FROM clock_timestamp())");
  clock_off_s_ = static_cast<double>(settings_.utc_ms()) / 1000.0 - clock.Real(0, 0);
}

bool CampaignForward::IsClockWrong() const { return std::abs(clock_off_s_) > kClockWrong_s; }

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

void CampaignForward::Remember(const JournalBatch& batch) {
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

// Everybody's: before the transaction, so that no bench waits for another one's batch.
std::int64_t CampaignForward::Send(Server& server, const JournalBatch& batch) {
  for (const SentResults& results : batch.results) {
    if (quantity_sets_.contains(results.quantities)) continue;
    quantity_sets_[results.quantities] =
        server.Run("SELECT strainwave.quantity_set_of($1::text[])", {ServerArray(results.quantities)}).Text(0, 0);
  }
  ServerTransaction transaction(server);
  const std::int64_t rows = SendCycles(server, batch) + SendResults(server, batch) + SendAlarms(server, batch) +
                            SendRows(server, batch);
  server.Run(
      "UPDATE strainwave.campaigns SET caught_up = $4 WHERE month = $1 AND bench_id = $2 AND campaign_id = $3 AND "
      "caught_up <> $4",
      PlaceAnd({batch.is_last ? "t" : "f"}));
  transaction.Commit();
  return rows;
}

void CampaignForward::SendState(Server& server, const CampaignSnapshot& snapshot, const Journal& journal) {
  const CampaignProgress& progress = snapshot.progress;
  // The newest that was raised; a campaign may have had none.
  const std::vector<AlarmInstance> alarms = journal.Alarms(-1.0);
  const ServerValue last_text = alarms.empty() ? ServerValue() : ServerText(alarms.back().text);
  const ServerValue last_utc = alarms.empty() ? ServerValue() : alarms.back().raised_utc;
  const std::string state =
      fmt::format("{} {} {} {} {} {} {}", NameOf(snapshot.view), progress.phase, progress.cycle, progress.cycles,
                  progress.complete, progress.open_alarms.size(), last_utc.value_or(""));
  const std::int64_t now_ms = settings_.utc_ms();
  // A clock may have been set back meanwhile.
  if (state == state_ && std::abs(now_ms - state_sent_ms_) < kStateAtLeastEvery_ms) return;
  MeasureClock(server);
  // Of two campaigns of a bench the one that was begun last counts, unless its clock was wrong or it has long
  // been silent.
  server.Run(
      "INSERT INTO strainwave.bench_states AS s (bench_id, campaign_id, started_utc, state, phase, cycle, cycles, "
      "complete, open_alarms, last_alarm, last_alarm_utc, bench_utc, clock_off_s, clock_wrong) VALUES ($1, $2, $3, "
      "$4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14) ON CONFLICT (bench_id) DO UPDATE SET campaign_id = "
      "excluded.campaign_id, started_utc = excluded.started_utc, state = excluded.state, phase = excluded.phase, "
      "cycle = excluded.cycle, cycles = excluded.cycles, complete = excluded.complete, open_alarms = "
      "excluded.open_alarms, last_alarm = excluded.last_alarm, last_alarm_utc = excluded.last_alarm_utc, bench_utc = "
      "excluded.bench_utc, clock_off_s = excluded.clock_off_s, clock_wrong = excluded.clock_wrong WHERE "
      "excluded.started_utc COLLATE \"C\" >= s.started_utc OR s.clock_wrong OR s.arrived < now() - interval '10 "
      "minutes'",
      {place_.bench_id, place_.campaign_id, ServerText(journal.Property("started_utc").value_or("")),
       std::string(NameOf(snapshot.view)), ServerText(progress.phase), std::to_string(progress.cycle),
       std::to_string(progress.cycles), std::to_string(progress.complete),
       std::to_string(progress.open_alarms.size()), last_text, last_utc, UtcText(now_ms), ServerNumber(clock_off_s_),
       IsClockWrong() ? "t" : "f"});
  state_ = state;
  state_sent_ms_ = now_ms;
}

}  // namespace strainwave::bench
