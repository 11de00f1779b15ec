// SPDX-License-Identifier: Apache-2.0
#include "bench/central/campaign_query.h"

#include <map>
#include <sstream>

#include <fmt/core.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kLongestQuery = 2000;

std::string ColumnOf(const std::string& key) {
  if (key == "bench") return "b.name";
  if (key == "specimen") return "c.specimen";
  if (key == "schedule") return "c.schedule_name";
  if (key == "campaign") return "c.identity";
  return "";
}

// As LIKE has it, with its own signs taken literally.
std::string PatternOf(const std::string& word) {
  std::string pattern;
  for (const char letter : word) {
    if (letter == '%' || letter == '_' || letter == '\\') pattern += '\\';
    pattern += letter == '*' ? '%' : letter == '?' ? '_' : letter;
  }
  return pattern;
}

bool Outdoes(const FoundCampaign& one, const FoundCampaign& other) {
  if (one.complete != other.complete) return one.complete > other.complete;
  return std::stoll(one.campaign_id) < std::stoll(other.campaign_id);
}

void MarkCopies(std::vector<FoundCampaign>& found) {
  std::map<std::string, const FoundCampaign*> counts;
  for (const FoundCampaign& one : found) {
    const FoundCampaign*& best = counts[one.identity];
    if (best == nullptr || Outdoes(one, *best)) best = &one;
  }
  for (FoundCampaign& one : found) {
    const FoundCampaign* const best = counts[one.identity];
    if (best != &one) one.same_as = best->Name();
  }
}

}  // namespace

CampaignQuery ParseCampaignQuery(const std::string& text) {
  const auto refuse = [](const std::string& word) {
    Refuse("--query", fmt::format("'{:.80}' is no condition", word),
           "bench=, specimen=, schedule= or campaign= with a value, such as bench=hall-* specimen=A1,A2");
  };
  if (text.size() > kLongestQuery) refuse(text);
  CampaignQuery query{"true", {}};
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    const std::string column = equals == word.npos ? "" : ColumnOf(word.substr(0, equals));
    if (column.empty() || equals + 1 == word.size()) refuse(word);
    std::string any;
    std::istringstream values(word.substr(equals + 1));
    for (std::string value; std::getline(values, value, ',');) {
      if (value.empty()) refuse(word);
      query.values.push_back(PatternOf(value));
      any += fmt::format("{}{} LIKE ${}", any.empty() ? "" : " OR ", column, query.values.size());
    }
    query.condition += fmt::format(" AND ({})", any);
  }
  return query;
}

std::vector<FoundCampaign> FindCampaigns(Server& server, const CampaignQuery& query, int most) {
  // From the end of each: no cycle is looked at but the last.
  const ServerRows rows = server.Run(
      fmt::format(
          "SELECT c.campaign_id, c.bench_id, c.month, b.name, c.specimen, c.schedule_name, c.identity, "
          "c.started_utc, coalesce(l.cycle, 0), c.caught_up FROM strainwave.campaigns c JOIN "
          "strainwave.benches b USING (bench_id) LEFT JOIN LATERAL (SELECT y.cycle FROM strainwave.cycles y "
          "WHERE y.month = c.month AND y.bench_id = c.bench_id AND y.campaign_id = c.campaign_id AND "
          "y.outcome "
          "= 'complete' ORDER BY y.cycle DESC LIMIT 1) l ON true WHERE {} ORDER BY b.name, c.started_utc, "
          "c.campaign_id LIMIT {}",
          query.condition, most),
      query.values);
  std::vector<FoundCampaign> found;
  for (int i = 0; i < rows.count(); ++i) {
    found.push_back({rows.Text(i, 0), rows.Text(i, 1), rows.Text(i, 2), rows.Text(i, 3), rows.Text(i, 4),
                     rows.Text(i, 5), rows.Text(i, 6), rows.Text(i, 7), static_cast<int>(rows.Integer(i, 8)),
                     rows.Truth(i, 9)});
  }
  MarkCopies(found);
  return found;
}

}  // namespace strainwave::bench
