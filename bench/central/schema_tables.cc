// SPDX-License-Identifier: Apache-2.0
// Version 1 of the server's tables. What a version has made is never edited: the next one changes it.
#include "bench/central/schema_versions.h"

namespace strainwave::bench {

// The month of a campaign is that in which it first came to the server, by the server's clock, so that a
// bench's wrong clock makes no partition of another century, and all rows of a campaign lie in one month's
// partitions. A cycle's results are arrays: a seventh of the bytes of a row for each
// (docs/central.md#partitions).
const char* const kTablesOfVersion1 = R"sql(
CREATE TABLE strainwave.benches(
  bench_id integer GENERATED ALWAYS AS IDENTITY PRIMARY KEY, name text NOT NULL UNIQUE, role name NOT NULL UNIQUE,
  machine text, added timestamptz NOT NULL DEFAULT now());
COMMENT ON COLUMN strainwave.benches.machine IS 'the machine that forwards for it; NULL: none has yet';

CREATE TABLE strainwave.campaigns(
  campaign_id integer GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  bench_id integer NOT NULL REFERENCES strainwave.benches, month date NOT NULL, identity text NOT NULL,
  schedule_name text NOT NULL, specimen text NOT NULL, started_utc text NOT NULL,
  caught_up boolean NOT NULL DEFAULT false, arrived timestamptz NOT NULL DEFAULT now(),
  UNIQUE(bench_id, identity));
CREATE INDEX campaigns_by_specimen ON strainwave.campaigns(specimen);
COMMENT ON COLUMN strainwave.campaigns.started_utc IS 'by the clock of the bench';

CREATE TABLE strainwave.bench_states(
  bench_id integer PRIMARY KEY REFERENCES strainwave.benches,
  campaign_id integer NOT NULL REFERENCES strainwave.campaigns, started_utc text NOT NULL, state text NOT NULL,
  phase text NOT NULL, cycle integer NOT NULL, cycles integer NOT NULL, complete integer NOT NULL,
  open_alarms integer NOT NULL, last_alarm text, last_alarm_utc text, bench_utc text NOT NULL,
  clock_off_s double precision NOT NULL, clock_wrong boolean NOT NULL, arrived timestamptz NOT NULL DEFAULT now())
  WITH (fillfactor = 50);

CREATE TABLE strainwave.inputs(
  sha256 text PRIMARY KEY, content bytea NOT NULL, CHECK (sha256 = encode(sha256(content), 'hex')));

CREATE TABLE strainwave.quantity_sets(
  quantity_set integer GENERATED ALWAYS AS IDENTITY PRIMARY KEY, names text[] NOT NULL UNIQUE);

CREATE TABLE strainwave.cycles(
  month date NOT NULL, bench_id integer NOT NULL, campaign_id integer NOT NULL, cycle integer NOT NULL,
  outcome text NOT NULL, started_s double precision NOT NULL, ended_s double precision, records_sha256 text NOT NULL,
  phases json NOT NULL, arrived timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY(month, bench_id, campaign_id, cycle)) PARTITION BY RANGE (month);

CREATE TABLE strainwave.result_rows(
  month date NOT NULL, bench_id integer NOT NULL, campaign_id integer NOT NULL, cycle integer NOT NULL,
  repeat smallint NOT NULL, quantity_set integer NOT NULL, result_values double precision[] NOT NULL,
  standard_errors double precision[] NOT NULL, flags text[], arrived timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY(month, bench_id, campaign_id, cycle, repeat)) PARTITION BY RANGE (month);

CREATE TABLE strainwave.alarms(
  month date NOT NULL, bench_id integer NOT NULL, campaign_id integer NOT NULL, number bigint NOT NULL,
  code text NOT NULL, alarm_text text NOT NULL, priority text NOT NULL, state text NOT NULL, cycle integer NOT NULL,
  raised_utc text NOT NULL, returned_utc text NOT NULL, acknowledged_by text NOT NULL, journal_row json NOT NULL,
  clock_wrong boolean NOT NULL, arrived timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY(month, bench_id, campaign_id, number)) PARTITION BY RANGE (month);

CREATE TYPE strainwave.journal_table AS ENUM(
  'campaign', 'calibrations', 'events', 'holes', 'operator_notes', 'alarm_actions', 'files', 'chain');
CREATE TABLE strainwave.journal_rows(
  month date NOT NULL, bench_id integer NOT NULL, campaign_id integer NOT NULL,
  journal_table strainwave.journal_table NOT NULL, number bigint NOT NULL, key text NOT NULL,
  journal_row json NOT NULL, arrived timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY(month, bench_id, campaign_id, journal_table, number, key)) PARTITION BY RANGE (month);

CREATE TABLE strainwave.records(
  month date NOT NULL, bench_id integer NOT NULL, campaign_id integer NOT NULL, path text NOT NULL,
  sha256 text NOT NULL, bytes bigint NOT NULL, arrived timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY(month, bench_id, campaign_id, path, sha256)) PARTITION BY RANGE (month);

CREATE VIEW strainwave.results WITH (security_invoker = true) AS
SELECT b.name AS bench, c.specimen, c.schedule_name, r.campaign_id, r.cycle, r.repeat, u.quantity, u.value,
  u.standard_error, r.flags[u.place] AS flag, r.arrived
FROM strainwave.result_rows r
JOIN strainwave.campaigns c USING (month, bench_id, campaign_id)
JOIN strainwave.benches b USING (bench_id)
JOIN strainwave.quantity_sets q USING (quantity_set)
CROSS JOIN LATERAL unnest(q.names, r.result_values, r.standard_errors) WITH ORDINALITY
  AS u(quantity, value, standard_error, place);

CREATE TABLE strainwave.months(month date PRIMARY KEY, made timestamptz NOT NULL DEFAULT now());
CREATE FUNCTION strainwave.make_month(day date) RETURNS void LANGUAGE plpgsql AS $$
DECLARE
  first date := date_trunc('month', day)::date;
  suffix text := to_char(first, 'YYYY_MM');
  parent text;
BEGIN
  IF EXISTS (SELECT 1 FROM strainwave.months m WHERE m.month = first) THEN RETURN; END IF;
  PERFORM pg_advisory_xact_lock(1398227286, 2);
  -- By a row and not by to_regclass, which after such a wait still answers from what it knew before.
  IF EXISTS (SELECT 1 FROM strainwave.months m WHERE m.month = first) THEN RETURN; END IF;
  INSERT INTO strainwave.months VALUES (first);
  FOREACH parent IN ARRAY ARRAY['cycles', 'result_rows', 'alarms', 'journal_rows', 'records'] LOOP
    EXECUTE format('CREATE TABLE strainwave.%I (LIKE strainwave.%I INCLUDING ALL) PARTITION BY HASH (bench_id)',
      parent || '_' || suffix, parent);
    FOR part IN 0..3 LOOP
      EXECUTE format('CREATE TABLE strainwave.%I PARTITION OF strainwave.%I FOR VALUES WITH (MODULUS 4, REMAINDER %s)',
        parent || '_' || suffix || '_' || part, parent || '_' || suffix, part);
    END LOOP;
    -- Attached, and not made as a part at once: that would keep out whoever reads or writes the other months.
    EXECUTE format('ALTER TABLE strainwave.%I ATTACH PARTITION strainwave.%I FOR VALUES FROM (%L) TO (%L)',
      parent, parent || '_' || suffix, first, (first + interval '1 month')::date);
  END LOOP;
END $$;
)sql";

}  // namespace strainwave::bench
