// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/cycle_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "analysis/quantities.h"
#include "analysis/units.h"

namespace strainwave::bench {
namespace {

constexpr double kHour_s = 3600.0;

struct Row {
  std::map<std::string, std::pair<double, double>> values;  // with their standard errors
  std::vector<std::string> flags;
};

// Those that the documents name in their order, then the others by name.
std::vector<std::string> InOrder(const std::map<std::string, int>& met) {
  std::vector<std::string> names;
  for (const analysis::Quantity& quantity : analysis::kQuantities) {
    if (met.contains(std::string(quantity.name))) names.emplace_back(quantity.name);
  }
  for (const auto& [name, count] : met) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

std::string Cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : std::string(); }

std::string QuotedFlags(const std::vector<std::string>& flags) {
  if (flags.empty()) return {};
  std::string text;
  for (const std::string& flag : flags) text += (text.empty() ? "" : "; ") + flag;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

CycleTable CycleTableOf(const Journal& journal) {
  std::map<int, Row> rows;
  std::map<std::string, int> met;
  journal.ForEachResult("", [&](const CycleResult& one) {
    Row& row = rows[one.cycle];
    row.values[one.result.quantity] = {one.result.value, one.result.standard_error};
    ++met[one.result.quantity];
    const std::string& flag = one.result.flag;
    if (!flag.empty() && std::ranges::find(row.flags, flag) == row.flags.end()) row.flags.push_back(flag);
    return true;
  });
  const std::vector<std::string> names = InOrder(met);
  CycleTable table;
  table.csv = "cycle,started_h,ended_h,load_h";
  for (const std::string& name : names) table.csv += fmt::format(",{0},{0}_se", name);
  table.csv += ",flags\n";
  table.columns = static_cast<int>(5 + 2 * names.size());
  double load_s = 0.0;
  for (const CycleRow& cycle : journal.Cycles()) {
    for (const PhaseRow& phase : journal.Phases(cycle.cycle)) load_s += phase.credited_load_s;
    if (cycle.cycle < 1 || cycle.outcome != "complete") continue;
    const Row& row = rows[cycle.cycle];
    table.csv += fmt::format("{},{},{},{}", cycle.cycle, cycle.started_s / kHour_s, cycle.ended_s / kHour_s,
                             load_s / kHour_s);
    for (const std::string& name : names) {
      const auto found = row.values.find(name);
      const bool known = found != row.values.end();
      table.csv += fmt::format(",{},{}", known ? Cell(found->second.first) : "",
                               known ? Cell(found->second.second) : "");
    }
    table.csv += fmt::format(",{}\n", QuotedFlags(row.flags));
    ++table.rows;
  }
  return table;
}

}  // namespace strainwave::bench
