// SPDX-License-Identifier: Apache-2.0
#include "bench/central/fleet_view.h"

#include <cmath>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/text.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

constexpr int kMostCompared = 200;

// Where something is looked for it may be in the names of a campaign as well; where nothing is, those are
// joined to the rows of one page alone.
constexpr const char* kFindInNames = R"sql(
  LEFT JOIN strainwave.campaigns f ON f.campaign_id = s.campaign_id AND f.bench_id = s.bench_id
  WHERE strpos(lower(b.name), $1) > 0 OR strpos(lower(f.specimen), $1) > 0 OR strpos(lower(f.schedule_name), $1) > 0)sql";

// Every bench once, narrow; counted by state and put in order, of which the rows of one page are widened. One
// row with the counts alone where a page has none.
constexpr const char* kBenchesOfAPage = R"sql(
WITH shown AS MATERIALIZED (
  SELECT b.bench_id, b.name, CASE WHEN s.bench_id IS NULL THEN 'never seen'
      WHEN s.state = 'running' AND s.arrived < now() - interval '15 minutes' THEN 'silent' ELSE s.state END AS shown_state,
    s.open_alarms > 0 OR s.clock_wrong AS is_noted
  FROM strainwave.benches b LEFT JOIN strainwave.bench_states s USING (bench_id) {find}),
ranked AS (
  SELECT *, CASE WHEN shown_state IN ('faulted', 'interrupted', 'silent', 'unreadable') THEN 0 WHEN is_noted THEN 1
      WHEN shown_state = 'running' THEN 2 ELSE 3 END AS rank
  FROM shown {state} ORDER BY rank, name COLLATE "C" LIMIT {most} OFFSET {from}),
page AS (
  SELECT name, shown_state, c.specimen, c.schedule_name, phase, cycle, cycles, complete, open_alarms, last_alarm,
    last_alarm_utc, extract(epoch FROM now() - s.arrived), clock_wrong, clock_off_s, rank
  FROM ranked LEFT JOIN strainwave.bench_states s USING (bench_id)
  LEFT JOIN strainwave.campaigns c ON c.campaign_id = s.campaign_id AND c.bench_id = s.bench_id)
SELECT page.*, states FROM
  (SELECT json_object_agg(shown_state, benches) AS states FROM
    (SELECT shown_state, count(*) AS benches FROM shown GROUP BY 1) x) y LEFT JOIN page ON true
ORDER BY rank, name COLLATE "C")sql";

json TextOrNull(const ServerRows& rows, int row, int column) {
  return rows.IsNull(row, column) ? json() : json(rows.Text(row, column));
}

json RealOrNull(const ServerRows& rows, int row, int column) {
  if (rows.IsNull(row, column)) return {};
  const double value = rows.Real(row, column);
  return std::isfinite(value) ? json(value) : json();
}

json IntegerOrNull(const ServerRows& rows, int row, int column) {
  return rows.IsNull(row, column) ? json() : json(rows.Integer(row, column));
}

void DemandQuantity(Server& server, const std::string& quantity) {
  const ServerRows known =
      server.Run("SELECT 1 FROM strainwave.quantity_sets WHERE $1 = ANY(names) LIMIT 1", {quantity});
  if (known.count() > 0) return;
  Refuse("quantity", fmt::format("the server has no results of '{:.80}'", quantity),
         "one of /api/v1/quantities");
}

std::string EndOf(const std::string& which, const char* direction) {
  return fmt::format(
      "LEFT JOIN LATERAL (SELECT r.cycle, r.result_values[array_position(q.names, $1)] AS value, "
      "r.standard_errors[array_position(q.names, $1)] AS standard_error FROM strainwave.result_rows r JOIN "
      "strainwave.quantity_sets q USING (quantity_set) WHERE r.month = m.month AND r.bench_id = m.bench_id "
      "AND "
      "r.campaign_id = m.campaign_id AND r.cycle > 0 AND r.repeat = 0 AND $1 = ANY(q.names) ORDER BY r.cycle "
      "{} LIMIT "
      "1) {} ON true ",
      direction, which);
}

}  // namespace

json BenchesJson(Server& server, const BenchesAsked& asked) {
  const std::string find = LowerCase(asked.find);
  std::vector<ServerValue> values;
  if (!find.empty()) values.emplace_back(find);
  if (!asked.state.empty()) values.emplace_back(asked.state);
  const ServerRows rows = server.Run(
      fmt::format(
          fmt::runtime(kBenchesOfAPage), fmt::arg("find", find.empty() ? "" : kFindInNames),
          fmt::arg("state", asked.state.empty() ? "" : fmt::format("WHERE shown_state = ${}", values.size())),
          fmt::arg("most", asked.most), fmt::arg("from", asked.from)),
      values);
  constexpr int kStates = 15;
  json states = rows.IsNull(0, kStates) ? json::object() : json::parse(rows.View(0, kStates));
  std::int64_t count = 0;
  for (const auto& [state, benches] : states.items()) {
    if (asked.state.empty() || asked.state == state) count += benches.get<std::int64_t>();
  }
  json benches = json::array();
  for (int i = 0; i < rows.count() && !rows.IsNull(i, 0); ++i) {
    benches.push_back({{"bench", rows.Text(i, 0)},
                       {"state", rows.Text(i, 1)},
                       {"specimen", TextOrNull(rows, i, 2)},
                       {"schedule", TextOrNull(rows, i, 3)},
                       {"phase", TextOrNull(rows, i, 4)},
                       {"cycle", IntegerOrNull(rows, i, 5)},
                       {"cycles", IntegerOrNull(rows, i, 6)},
                       {"complete", IntegerOrNull(rows, i, 7)},
                       {"open_alarms", IntegerOrNull(rows, i, 8)},
                       {"last_alarm", TextOrNull(rows, i, 9)},
                       {"last_alarm_utc", TextOrNull(rows, i, 10)},
                       {"seen_s_ago", RealOrNull(rows, i, 11)},
                       {"clock_wrong", rows.Truth(i, 12)},
                       {"clock_off_s", RealOrNull(rows, i, 13)}});
  }
  return {
      {"states", std::move(states)}, {"count", count}, {"from", asked.from}, {"benches", std::move(benches)}};
}

json ComparisonJson(Server& server, const std::string& quantity, const CampaignQuery& query) {
  DemandQuantity(server, quantity);
  // The quantity is $1 and comes again behind the query's own values, which begin with $1 in its words.
  std::vector<ServerValue> values{quantity};
  values.insert(values.end(), query.values.begin(), query.values.end());
  std::string condition;
  for (std::size_t i = 0; i < query.condition.size(); ++i) {
    condition += query.condition[i];
    if (query.condition[i] != '$') continue;
    std::size_t digits = 0;
    condition += std::to_string(std::stoi(query.condition.substr(i + 1), &digits) + 1);
    i += digits;
  }
  const ServerRows rows = server.Run(
      fmt::format(
          "SELECT m.name, m.specimen, m.schedule_name, m.started_utc, f.cycle, f.value, f.standard_error, "
          "l.cycle, l.value, l.standard_error FROM (SELECT b.name, c.* FROM strainwave.campaigns c JOIN "
          "strainwave.benches b USING (bench_id) WHERE {} ORDER BY c.specimen, c.campaign_id LIMIT {}) m {} "
          "{} "
          "WHERE f.cycle IS NOT NULL ORDER BY m.specimen, m.campaign_id",
          condition, kMostCompared, EndOf("f", "ASC"), EndOf("l", "DESC")),
      values);
  json campaigns = json::array();
  for (int i = 0; i < rows.count(); ++i) {
    campaigns.push_back({{"bench", rows.Text(i, 0)},
                         {"specimen", rows.Text(i, 1)},
                         {"schedule", rows.Text(i, 2)},
                         {"started_utc", rows.Text(i, 3)},
                         {"first_cycle", IntegerOrNull(rows, i, 4)},
                         {"first", RealOrNull(rows, i, 5)},
                         {"first_se", RealOrNull(rows, i, 6)},
                         {"last_cycle", IntegerOrNull(rows, i, 7)},
                         {"last", RealOrNull(rows, i, 8)},
                         {"last_se", RealOrNull(rows, i, 9)}});
  }
  return {{"quantity", quantity}, {"most", kMostCompared}, {"campaigns", std::move(campaigns)}};
}

json QuantitiesJson(Server& server) {
  const ServerRows rows =
      server.Run("SELECT DISTINCT unnest(names) FROM strainwave.quantity_sets ORDER BY 1");
  json names = json::array();
  for (int i = 0; i < rows.count(); ++i) names.push_back(rows.Text(i, 0));
  return {{"quantities", std::move(names)}};
}

}  // namespace strainwave::bench
