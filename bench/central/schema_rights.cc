// SPDX-License-Identifier: Apache-2.0
// Version 2: who may do what. A bench has a role of its own and sees and writes its own rows only; readers
// see all and write nothing; whoever has made the tables may do everything.
#include "bench/central/schema_versions.h"

namespace strainwave::bench {

// `arrived` is the server's stamp: nobody but the tables' owner gives it another value. What a bench may not
// do by itself (to add a campaign, a month, a set of quantities, an input file) is done by functions, which
// run with the rights of the tables' owner.
const char* const kRightsOfVersion2 = R"sql(
DO $$
DECLARE wanted text;
BEGIN
  PERFORM pg_advisory_xact_lock(1398227286, 3);
  FOREACH wanted IN ARRAY ARRAY['strainwave_bench', 'strainwave_reader'] LOOP
    IF NOT EXISTS (SELECT 1 FROM pg_roles WHERE rolname = wanted) THEN
      EXECUTE format('CREATE ROLE %I NOLOGIN', wanted);
    END IF;
  END LOOP;
END $$;

CREATE FUNCTION strainwave.own_bench() RETURNS integer LANGUAGE sql STABLE SECURITY DEFINER
SET search_path = pg_catalog, pg_temp AS $$
  SELECT bench_id FROM strainwave.benches WHERE role = session_user
$$;

CREATE FUNCTION strainwave.register_campaign(
  wanted_machine text, wanted_identity text, wanted_schedule text, wanted_specimen text, wanted_started text,
  OUT bench text, OUT bench_number integer, OUT campaign_number integer, OUT campaign_month date)
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $$
DECLARE
  own strainwave.benches;
BEGIN
  SELECT * INTO own FROM strainwave.benches WHERE role = session_user FOR UPDATE;
  IF NOT FOUND THEN
    RAISE EXCEPTION USING ERRCODE = 'SW001', MESSAGE = format('%s is not the role of a bench', session_user),
      HINT = 'that of one, which strainwave central add-bench NAME makes';
  END IF;
  IF own.machine IS NULL THEN
    UPDATE strainwave.benches SET machine = wanted_machine WHERE bench_id = own.bench_id;
  ELSIF own.machine <> wanted_machine THEN
    RAISE EXCEPTION USING ERRCODE = 'SW002',
      MESSAGE = format('bench %s is forwarded by another machine already', own.name),
      HINT = format('a name for each bench; where its machine was replaced: strainwave central add-bench %s --new-machine',
        own.name);
  END IF;
  INSERT INTO strainwave.campaigns(bench_id, month, identity, schedule_name, specimen, started_utc)
  VALUES (own.bench_id, date_trunc('month', now() AT TIME ZONE 'UTC')::date, wanted_identity, wanted_schedule,
    wanted_specimen, wanted_started) ON CONFLICT (bench_id, identity) DO NOTHING;
  SELECT own.name, c.bench_id, c.campaign_id, c.month INTO bench, bench_number, campaign_number, campaign_month
  FROM strainwave.campaigns c WHERE c.bench_id = own.bench_id AND c.identity = wanted_identity;
  PERFORM strainwave.make_month(campaign_month);
END $$;

CREATE FUNCTION strainwave.keep_input(text_of_it bytea) RETURNS void LANGUAGE sql SECURITY DEFINER
SET search_path = pg_catalog, pg_temp AS $$
  INSERT INTO strainwave.inputs VALUES (encode(sha256(text_of_it), 'hex'), text_of_it) ON CONFLICT DO NOTHING
$$;

CREATE FUNCTION strainwave.quantity_set_of(wanted text[]) RETURNS integer LANGUAGE plpgsql SECURITY DEFINER
SET search_path = pg_catalog, pg_temp AS $$
DECLARE
  found integer;
BEGIN
  SELECT q.quantity_set INTO found FROM strainwave.quantity_sets q WHERE q.names = wanted;
  IF found IS NULL THEN
    INSERT INTO strainwave.quantity_sets(names) VALUES (wanted) ON CONFLICT DO NOTHING;
    SELECT q.quantity_set INTO found FROM strainwave.quantity_sets q WHERE q.names = wanted;
  END IF;
  RETURN found;
END $$;

CREATE FUNCTION strainwave.stamp_arrival() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  NEW.arrived := now();
  RETURN NEW;
END $$;
CREATE TRIGGER stamp_arrival BEFORE INSERT OR UPDATE ON strainwave.bench_states
FOR EACH ROW EXECUTE FUNCTION strainwave.stamp_arrival();

DO $$
DECLARE
  name text;
BEGIN
  FOREACH name IN ARRAY ARRAY['campaigns', 'bench_states', 'cycles', 'result_rows', 'alarms', 'journal_rows', 'records']
  LOOP
    EXECUTE format('ALTER TABLE strainwave.%I ENABLE ROW LEVEL SECURITY', name);
    -- In brackets of its own the function is called once a statement, not once a row.
    EXECUTE format('CREATE POLICY own_rows ON strainwave.%I TO strainwave_bench '
      'USING (bench_id = (SELECT strainwave.own_bench())) WITH CHECK (bench_id = (SELECT strainwave.own_bench()))', name);
    EXECUTE format('CREATE POLICY all_rows ON strainwave.%I FOR SELECT TO strainwave_reader USING (true)', name);
  END LOOP;
END $$;
ALTER TABLE strainwave.benches ENABLE ROW LEVEL SECURITY;
CREATE POLICY own_row ON strainwave.benches FOR SELECT TO strainwave_bench USING (role = session_user);
CREATE POLICY all_rows ON strainwave.benches FOR SELECT TO strainwave_reader USING (true);

REVOKE ALL ON ALL FUNCTIONS IN SCHEMA strainwave FROM PUBLIC;
GRANT USAGE ON SCHEMA strainwave TO strainwave_bench, strainwave_reader;
GRANT SELECT ON strainwave.versions, strainwave.benches, strainwave.campaigns, strainwave.bench_states, strainwave.inputs,
  strainwave.quantity_sets, strainwave.cycles, strainwave.result_rows, strainwave.alarms, strainwave.journal_rows,
  strainwave.records, strainwave.results TO strainwave_bench, strainwave_reader;
GRANT EXECUTE ON FUNCTION strainwave.own_bench, strainwave.register_campaign, strainwave.keep_input,
  strainwave.quantity_set_of TO strainwave_bench;
GRANT UPDATE(caught_up) ON strainwave.campaigns TO strainwave_bench;
GRANT INSERT, UPDATE ON strainwave.bench_states TO strainwave_bench;
GRANT INSERT(month, bench_id, campaign_id, cycle, outcome, started_s, ended_s, records_sha256, phases),
  UPDATE(outcome, ended_s, records_sha256, phases) ON strainwave.cycles TO strainwave_bench;
GRANT INSERT(month, bench_id, campaign_id, cycle, repeat, quantity_set, result_values, standard_errors, flags)
  ON strainwave.result_rows TO strainwave_bench;
GRANT INSERT(month, bench_id, campaign_id, number, code, alarm_text, priority, state, cycle, raised_utc, returned_utc,
    acknowledged_by, journal_row, clock_wrong),
  UPDATE(alarm_text, priority, state, returned_utc, acknowledged_by, journal_row) ON strainwave.alarms TO strainwave_bench;
GRANT INSERT(month, bench_id, campaign_id, journal_table, number, key, journal_row), UPDATE(journal_row)
  ON strainwave.journal_rows TO strainwave_bench;
GRANT INSERT(month, bench_id, campaign_id, path, sha256, bytes) ON strainwave.records TO strainwave_bench;
)sql";

}  // namespace strainwave::bench
