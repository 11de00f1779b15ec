// SPDX-License-Identifier: Apache-2.0
// Of CampaignSender: how each kind of row goes into its table. All come through a temporary table, so that
// what the server has already is left as it is.
#include <fmt/core.h>

#include "bench/central/campaign_sender.h"
#include "bench/central/copy_text.h"

namespace strainwave::bench {

std::int64_t CampaignSender::SendCycles(Server& server, const JournalBatch& batch) {
  CopyText text;
  for (const SentCycle& cycle : batch.cycles) {
    text.Integer(cycle.cycle).Text(cycle.outcome).Real(cycle.started_s).Real(cycle.ended_s);
    text.Text(cycle.records_sha256).Text(cycle.phases).EndRow();
  }
  if (text.count() == 0) return 0;
  server.Copy("COPY sent_cycles FROM STDIN", text.rows());
  const ServerRows written = server.Run(
      "INSERT INTO strainwave.cycles AS c (month, bench_id, campaign_id, cycle, outcome, started_s, ended_s, "
      "records_sha256, phases) SELECT $1::date, $2::integer, $3::integer, s.* FROM sent_cycles s ON CONFLICT "
      "(month, "
      "bench_id, campaign_id, cycle) DO UPDATE SET outcome = excluded.outcome, ended_s = excluded.ended_s, "
      "records_sha256 = excluded.records_sha256, phases = excluded.phases WHERE c.outcome <> 'complete'",
      PlaceAnd({}));
  return written.affected();
}

std::int64_t CampaignSender::SendResults(Server& server, const JournalBatch& batch) {
  CopyText text;
  for (const SentResults& results : batch.results) {
    text.Integer(results.cycle).Integer(results.repeat).Text(quantity_sets_.at(results.quantities));
    text.Reals(results.values).Reals(results.standard_errors);
    bool is_flagged = false;
    for (const std::string& flag : results.flags) is_flagged = is_flagged || !flag.empty();
    is_flagged ? text.Texts(results.flags) : text.Null();
    text.EndRow();
  }
  if (text.count() == 0) return 0;
  server.Copy("COPY sent_results FROM STDIN", text.rows());
  const ServerRows written = server.Run(
      "INSERT INTO strainwave.result_rows (month, bench_id, campaign_id, cycle, repeat, quantity_set, "
      "result_values, "
      "standard_errors, flags) SELECT $1::date, $2::integer, $3::integer, s.* FROM sent_results s ON "
      "CONFLICT DO "
      "NOTHING",
      PlaceAnd({}));
  return written.affected();
}

std::int64_t CampaignSender::SendAlarms(Server& server, const JournalBatch& batch) {
  CopyText text;
  for (const SentAlarm& alarm : batch.alarms) {
    const AlarmInstance& one = alarm.instance;
    text.Integer(one.number).Text(one.code).Text(one.text).Text(Name(one.priority)).Text(Name(one.state));
    text.Integer(one.cycle)
        .Text(one.raised_utc)
        .Text(one.returned_utc)
        .Text(one.acknowledged_by)
        .Text(alarm.row);
    text.EndRow();
  }
  if (text.count() == 0) return 0;
  server.Copy("COPY sent_alarms FROM STDIN", text.rows());
  // A stamp of a day to come is wrong, whatever the bench's clock says now; stamps of this form sort by time.
  const ServerRows written = server.Run(
      "INSERT INTO strainwave.alarms AS a (month, bench_id, campaign_id, number, code, alarm_text, priority, "
      "state, "
      "cycle, raised_utc, returned_utc, acknowledged_by, journal_row, clock_wrong) SELECT $1::date, "
      "$2::integer, "
      "$3::integer, s.*, $4::boolean OR s.raised_utc COLLATE \"C\" > to_char((now() + interval '1 day') AT "
      "TIME ZONE "
      "'UTC', 'YYYY-MM-DD\"T\"HH24:MI:SS') FROM sent_alarms s ON CONFLICT (month, bench_id, campaign_id, "
      "number) DO "
      "UPDATE SET alarm_text = excluded.alarm_text, priority = excluded.priority, state = excluded.state, "
      "returned_utc = excluded.returned_utc, acknowledged_by = excluded.acknowledged_by, journal_row = "
      "excluded.journal_row WHERE a.journal_row::text <> excluded.journal_row::text",
      PlaceAnd({ClockIsWrong()}));
  return written.affected();
}

std::int64_t CampaignSender::SendRows(Server& server, const JournalBatch& batch) {
  CopyText text;
  for (const SentRow& row : batch.rows) {
    text.Text(row.table).Integer(row.number).Text(row.key).Text(row.row).EndRow();
  }
  if (text.count() == 0) return 0;
  server.Copy("COPY sent_rows FROM STDIN", text.rows());
  const ServerRows written = server.Run(
      "INSERT INTO strainwave.journal_rows AS j (month, bench_id, campaign_id, journal_table, number, key, "
      "journal_row) SELECT $1::date, $2::integer, $3::integer, s.* FROM sent_rows s ON CONFLICT (month, "
      "bench_id, "
      "campaign_id, journal_table, number, key) DO UPDATE SET journal_row = excluded.journal_row WHERE "
      "j.number = 0 "
      "AND j.journal_row::text <> excluded.journal_row::text",
      PlaceAnd({}));
  return written.affected();
}

}  // namespace strainwave::bench
