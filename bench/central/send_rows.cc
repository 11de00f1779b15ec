// SPDX-License-Identifier: Apache-2.0
// Of CampaignSender: how each kind of row goes into its table. What the server has already is left as it is.
#include <utility>

#include "bench/central/campaign_sender.h"
#include "bench/central/server_columns.h"

namespace strainwave::bench {
namespace {

// How many rows the statement wrote. Its first parameters are `before`, a column each the others.
std::int64_t WriteRows(Server& server, const char* statement, std::vector<ServerValue> before,
                       const ServerColumns& columns) {
  if (columns.count() == 0) return 0;
  return server.Run(statement, columns.After(std::move(before))).affected();
}

}  // namespace

std::int64_t CampaignSender::SendCycles(Server& server, const JournalBatch& batch) {
  ServerColumns columns;
  for (const SentCycle& cycle : batch.cycles) {
    columns.Integer(cycle.cycle).Text(cycle.outcome).Real(cycle.started_s).Real(cycle.ended_s);
    columns.Text(cycle.records_sha256).Text(cycle.phases).EndRow();
  }
  return WriteRows(
      server,
      "INSERT INTO strainwave.cycles AS c (month, bench_id, campaign_id, cycle, outcome, started_s, ended_s, "
      "records_sha256, phases) SELECT $1::date, $2::integer, $3::integer, s.cycle, s.outcome, s.started_s, "
      "s.ended_s, "
      "s.records_sha256, s.phases::json FROM unnest($4::integer[], $5::text[], $6::double precision[], "
      "$7::double "
      "precision[], $8::text[], $9::text[]) AS s(cycle, outcome, started_s, ended_s, records_sha256, phases) "
      "ON CONFLICT "
      "(month, bench_id, campaign_id, cycle) DO UPDATE SET outcome = excluded.outcome, ended_s = "
      "excluded.ended_s, "
      "records_sha256 = excluded.records_sha256, phases = excluded.phases WHERE c.outcome <> 'complete'",
      PlaceAnd({}), columns);
}

std::int64_t CampaignSender::SendResults(Server& server, const JournalBatch& batch) {
  ServerColumns columns;
  for (const SentResults& results : batch.results) {
    columns.Integer(results.cycle).Integer(results.repeat).Text(quantity_sets_.at(results.quantities));
    columns.Reals(results.values).Reals(results.standard_errors);
    bool is_flagged = false;
    for (const std::string& flag : results.flags) is_flagged = is_flagged || !flag.empty();
    is_flagged ? columns.Texts(results.flags) : columns.Null();
    columns.EndRow();
  }
  return WriteRows(
      server,
      "INSERT INTO strainwave.result_rows (month, bench_id, campaign_id, cycle, repeat, quantity_set, "
      "result_values, "
      "standard_errors, flags) SELECT $1::date, $2::integer, $3::integer, s.cycle, s.repeat, s.quantity_set, "
      "s.result_values::double precision[], s.standard_errors::double precision[], s.flags::text[] FROM "
      "unnest($4::integer[], $5::smallint[], $6::integer[], $7::text[], $8::text[], $9::text[]) AS s(cycle, "
      "repeat, "
      "quantity_set, result_values, standard_errors, flags) ON CONFLICT DO NOTHING",
      PlaceAnd({}), columns);
}

std::int64_t CampaignSender::SendAlarms(Server& server, const JournalBatch& batch) {
  ServerColumns columns;
  for (const SentAlarm& alarm : batch.alarms) {
    const AlarmInstance& one = alarm.instance;
    columns.Integer(one.number).Text(one.code).Text(one.text).Text(Name(one.priority)).Text(Name(one.state));
    columns.Integer(one.cycle).Text(one.raised_utc).Text(one.returned_utc).Text(one.acknowledged_by);
    columns.Text(alarm.row).EndRow();
  }
  // A stamp of a day to come is wrong, whatever the bench's clock says now; stamps of this form sort by time.
  return WriteRows(
      server,
      "INSERT INTO strainwave.alarms AS a (month, bench_id, campaign_id, number, code, alarm_text, priority, "
      "state, "
      "cycle, raised_utc, returned_utc, acknowledged_by, journal_row, clock_wrong) SELECT $1::date, "
      "$2::integer, "
      "$3::integer, s.number, s.code, s.alarm_text, s.priority, s.state, s.cycle, s.raised_utc, "
      "s.returned_utc, "
      "s.acknowledged_by, s.journal_row::json, $4::boolean OR s.raised_utc COLLATE \"C\" > to_char((now() + "
      "interval '1 "
      "day') AT TIME ZONE 'UTC', 'YYYY-MM-DD\"T\"HH24:MI:SS') FROM unnest($5::bigint[], $6::text[], "
      "$7::text[], "
      "$8::text[], $9::text[], $10::integer[], $11::text[], $12::text[], $13::text[], $14::text[]) AS "
      "s(number, code, "
      "alarm_text, priority, state, cycle, raised_utc, returned_utc, acknowledged_by, journal_row) ON "
      "CONFLICT (month, "
      "bench_id, campaign_id, number) DO UPDATE SET alarm_text = excluded.alarm_text, priority = "
      "excluded.priority, "
      "state = excluded.state, returned_utc = excluded.returned_utc, acknowledged_by = "
      "excluded.acknowledged_by, "
      "journal_row = excluded.journal_row WHERE a.journal_row::text <> excluded.journal_row::text",
      PlaceAnd({ClockIsWrong()}), columns);
}

std::int64_t CampaignSender::SendRows(Server& server, const JournalBatch& batch) {
  ServerColumns columns;
  for (const SentRow& row : batch.rows) {
    columns.Text(row.table).Integer(row.number).Text(row.key).Text(row.row).EndRow();
  }
  return WriteRows(
      server,
      "INSERT INTO strainwave.journal_rows AS j (month, bench_id, campaign_id, journal_table, number, key, "
      "journal_row) SELECT $1::date, $2::integer, $3::integer, s.journal_table::strainwave.journal_table, "
      "s.number, "
      "s.key, s.journal_row::json FROM unnest($4::text[], $5::bigint[], $6::text[], $7::text[]) AS "
      "s(journal_table, "
      "number, key, journal_row) ON CONFLICT (month, bench_id, campaign_id, journal_table, number, key) DO "
      "UPDATE SET "
      "journal_row = excluded.journal_row WHERE j.number = 0 AND j.journal_row::text <> "
      "excluded.journal_row::text",
      PlaceAnd({}), columns);
}

}  // namespace strainwave::bench
