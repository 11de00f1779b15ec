// SPDX-License-Identifier: Apache-2.0
#include "bench/central/campaign_sender.h"

#include <cmath>

#include <fmt/core.h>

#include "bench/central/server_columns.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

constexpr const char* kOfCampaign = "WHERE month = $1 AND bench_id = $2 AND campaign_id = $3";

}  // namespace

void CampaignSender::Begin(Server& server, const std::string& machine, const SentCampaign& campaign,
                           std::int64_t utc_ms) {
  MeasureClock(server, utc_ms);
  started_utc_ = ServerText(campaign.started_utc);
  const ServerRows place = server.Run("SELECT * FROM strainwave.register_campaign($1, $2, $3, $4, $5)",
                                      {machine, campaign.identity, ServerText(campaign.schedule),
                                       ServerText(campaign.specimen), started_utc_});
  bench_ = place.Text(0, 0);
  bench_id_ = place.Text(0, 1);
  campaign_id_ = place.Text(0, 2);
  month_ = place.Text(0, 3);
}

void CampaignSender::KeepInput(Server& server, const std::string& bytes) {
  std::string hex = "\\x";
  for (const char byte : bytes) hex += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  server.Run("SELECT strainwave.keep_input($1::bytea)", {hex});
}

JournalMarks CampaignSender::Marks(Server& server) const {
  JournalMarks marks;
  const ServerRows cycle = server.Run(
      fmt::format(
          "SELECT coalesce(max(cycle) FILTER (WHERE outcome = 'complete'), -1) FROM strainwave.cycles {}",
          kOfCampaign),
      PlaceAnd({}));
  marks.cycle = static_cast<int>(cycle.Integer(0, 0));
  const ServerRows tables =
      server.Run(fmt::format("SELECT journal_table, max(number) FROM strainwave.journal_rows {} GROUP BY 1",
                             kOfCampaign),
                 PlaceAnd({}));
  for (int i = 0; i < tables.count(); ++i) marks.table[tables.Text(i, 0)] = tables.Integer(i, 1);
  return marks;
}

std::set<std::string> CampaignSender::Records(Server& server) const {
  const ServerRows rows =
      server.Run(fmt::format("SELECT path, sha256 FROM strainwave.records {}", kOfCampaign), PlaceAnd({}));
  std::set<std::string> records;
  for (int i = 0; i < rows.count(); ++i) records.insert(rows.Text(i, 0) + ' ' + rows.Text(i, 1));
  return records;
}

void CampaignSender::MeasureClock(Server& server, std::int64_t utc_ms) {
  const ServerRows clock = server.Run("SELECT extract(epoch FROM clock_timestamp())");
  clock_off_s_ = static_cast<double>(utc_ms) / 1000.0 - clock.Real(0, 0);
}

ServerValue CampaignSender::ClockIsWrong() const {
  return std::abs(clock_off_s_) > kClockWrong_s ? "t" : "f";
}

std::vector<ServerValue> CampaignSender::PlaceAnd(std::initializer_list<ServerValue> more) const {
  std::vector<ServerValue> values{month_, bench_id_, campaign_id_};
  values.insert(values.end(), more.begin(), more.end());
  return values;
}

std::int64_t CampaignSender::Send(Server& server, const JournalBatch& batch) {
  // Everybody's: before the transaction, so that no bench waits for another one's batch.
  for (const SentResults& results : batch.results) {
    if (quantity_sets_.contains(results.quantities)) continue;
    quantity_sets_[results.quantities] =
        server.Run("SELECT strainwave.quantity_set_of($1::text[])", {ServerArray(results.quantities)})
            .Text(0, 0);
  }
  ServerTransaction transaction(server);
  const std::int64_t rows = SendCycles(server, batch) + SendResults(server, batch) +
                            SendAlarms(server, batch) + SendRows(server, batch);
  server.Run(
      "UPDATE strainwave.campaigns SET caught_up = $4 WHERE month = $1 AND bench_id = $2 AND campaign_id = "
      "$3 AND "
      "caught_up <> $4",
      PlaceAnd({batch.is_last ? "t" : "f"}));
  transaction.Commit();
  return rows;
}

void CampaignSender::SendState(Server& server, const SentState& state, std::int64_t utc_ms) {
  MeasureClock(server, utc_ms);
  // Of two campaigns of a bench the one that was begun last counts, unless its clock was wrong or it has long
  // been silent.
  server.Run(
      "INSERT INTO strainwave.bench_states AS s (bench_id, campaign_id, started_utc, state, phase, cycle, "
      "cycles, "
      "complete, open_alarms, last_alarm, last_alarm_utc, bench_utc, clock_off_s, clock_wrong) VALUES ($1, "
      "$2, $3, "
      "$4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14) ON CONFLICT (bench_id) DO UPDATE SET campaign_id = "
      "excluded.campaign_id, started_utc = excluded.started_utc, state = excluded.state, phase = "
      "excluded.phase, "
      "cycle = excluded.cycle, cycles = excluded.cycles, complete = excluded.complete, open_alarms = "
      "excluded.open_alarms, last_alarm = excluded.last_alarm, last_alarm_utc = excluded.last_alarm_utc, "
      "bench_utc = "
      "excluded.bench_utc, clock_off_s = excluded.clock_off_s, clock_wrong = excluded.clock_wrong WHERE "
      "excluded.started_utc COLLATE \"C\" >= s.started_utc OR s.clock_wrong OR s.arrived < now() - interval "
      "'1 hour'",
      {bench_id_, campaign_id_, started_utc_, state.state, ServerText(state.phase),
       std::to_string(state.cycle), std::to_string(state.cycles), std::to_string(state.complete),
       std::to_string(state.open_alarms), state.last_alarm, state.last_alarm_utc, UtcText(utc_ms),
       ServerNumber(clock_off_s_), ClockIsWrong()});
}

void CampaignSender::SendRecord(Server& server, const std::string& path, const std::string& sha256,
                                std::uint64_t bytes) {
  server.Run(
      "INSERT INTO strainwave.records(month, bench_id, campaign_id, path, sha256, bytes) VALUES ($1, $2, $3, "
      "$4, $5, "
      "$6) ON CONFLICT DO NOTHING",
      PlaceAnd({ServerText(path), sha256, std::to_string(bytes)}));
}

}  // namespace strainwave::bench
