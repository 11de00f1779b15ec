// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/trail.h"

namespace strainwave::bench {
namespace {

// A link without its row stays in the list: that the row is gone is what has to be seen.
constexpr const char* kTrail = R"(
SELECT c.number, c.kind, c.sha256,
  CASE c.kind WHEN 'event' THEN e.utc WHEN 'hole' THEN h.end_utc WHEN 'note' THEN n.utc
              WHEN 'alarm action' THEN a.utc
              ELSE (SELECT value FROM campaign WHERE key = 'started_utc') END,
  CASE c.kind WHEN 'note' THEN n.author
              WHEN 'alarm action' THEN CASE a.author WHEN '' THEN 'the program' ELSE a.author END
              WHEN 'event' THEN CASE WHEN e.severity = 'action' OR e.code IN ('acknowledged', 'extended')
                                THEN 'a person' ELSE 'the program' END
              ELSE 'the program' END,
  CASE c.kind WHEN 'event' THEN e.text
              WHEN 'hole' THEN 'out of sight since ' || h.start_utc || ': ' || h.cause
              WHEN 'note' THEN n.text
              WHEN 'alarm action' THEN 'alarm ' || a.number || ': ' || a.action ||
                   CASE a.text WHEN '' THEN '' ELSE ': ' || a.text END
              ELSE c.key || ': ' || CASE p.value WHEN '' THEN 'none' ELSE p.value END END
FROM chain c
LEFT JOIN campaign p ON c.kind = 'property' AND p.key = c.key
LEFT JOIN events e ON c.kind = 'event' AND e.id = CAST(c.key AS INTEGER)
LEFT JOIN holes h ON c.kind = 'hole' AND h.id = CAST(c.key AS INTEGER)
LEFT JOIN operator_notes n ON c.kind = 'note' AND n.id = CAST(c.key AS INTEGER)
LEFT JOIN alarm_actions a ON c.kind = 'alarm action' AND a.id = CAST(c.key AS INTEGER)
WHERE c.kind NOT IN ('cycle', 'file') ORDER BY c.number)";

}  // namespace

std::vector<TrailEntry> TrailOf(const Journal& journal) {
  std::vector<TrailEntry> trail;
  if (!HasChain(journal.database())) return trail;
  Statement links = journal.database().Prepare(kTrail);
  while (links.Step()) {
    trail.push_back(
        {links.Integer(0), links.Text(1), links.Text(3), links.Text(4), links.Text(5), links.Text(2)});
  }
  return trail;
}

CutPhases CutPhasesOf(const Journal& journal) {
  CutPhases cut;
  Statement phases = journal.database().Prepare(
      "SELECT kind = 'load_run', COUNT(*), SUM(credited_load_s) FROM phases "
      "WHERE outcome NOT IN ('complete', 'running') GROUP BY kind = 'load_run'");
  while (phases.Step()) {
    (phases.Integer(0) != 0 ? cut.load_runs : cut.others) = static_cast<int>(phases.Integer(1));
    cut.kept_load_s += phases.Real(2);
  }
  Statement cycles = journal.database().Prepare(
      "SELECT COUNT(DISTINCT p.cycle), COUNT(DISTINCT CASE WHEN c.outcome = 'complete' THEN c.cycle END) "
      "FROM phases p JOIN cycles c ON c.cycle = p.cycle WHERE p.outcome NOT IN ('complete', 'running')");
  if (cycles.Step()) {
    cut.cycles = static_cast<int>(cycles.Integer(0));
    cut.cycles_complete = static_cast<int>(cycles.Integer(1));
  }
  return cut;
}

}  // namespace strainwave::bench
