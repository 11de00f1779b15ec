// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/results_table.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/campaign.h"
#include "bench/campaign/cycle_results.h"
#include "bench/campaign/pictures.h"
#include "bench/campaign/quality.h"
#include "bench/commands/error_text.h"
#include "bench/commands/output.h"
#include "bench/commands/terminal.h"
#include "bench/plots/gnuplot.h"

namespace strainwave::bench {
namespace {

namespace quantities = analysis::quantities;
using analysis::StiffnessMethod;

constexpr std::array kColumns{
    quantities::kEAvg, quantities::kEMax, quantities::kLostMotion, quantities::kK1,
    quantities::kK2,   quantities::kK3,   quantities::kHysteresis, quantities::kGearTemperature};
constexpr std::size_t kMostRows = 24;

std::vector<int> CompleteCycles(const std::vector<CycleRow>& cycles) {
  std::vector<int> all;
  for (const CycleRow& row : cycles) {
    if (row.cycle > 0 && row.outcome == "complete") all.push_back(row.cycle);
  }
  return all;
}

// All cycles of a short campaign; of a long one the first, the last, and equally spaced ones between.
std::vector<int> CyclesShown(const std::vector<int>& all) {
  if (all.size() <= kMostRows) return all;
  std::vector<int> shown;
  for (std::size_t i = 0; i < kMostRows; ++i) shown.push_back(all[i * (all.size() - 1) / (kMostRows - 1)]);
  return shown;
}

void PrintTable(const Journal& journal, const std::vector<int>& cycles) {
  ToStdout("{:>6}", "cycle");
  for (const analysis::Quantity& column : kColumns)
    ToStdout(" {:>{}}", ColumnTitle(column), column.units().width);
  ToStdout("\n");
  for (const int cycle : cycles) {
    const std::vector<Result> results = journal.Results(cycle, 0);
    ToStdout("{:>6}", cycle);
    std::string flags;
    for (const auto& column : kColumns) {
      const auto result = FindResult(results, column.name);
      ToStdout(" {}", ValueCell(result ? result->value : std::nan(""), column.units().width,
                                column.units().decimals));
      if (result && !result->flag.empty() && flags.find(result->flag) == std::string::npos)
        flags += "  " + result->flag;
    }
    ToStdout("{}\n", flags);
  }
}

// A change is claimed beside what the gauge repeats to.
void PrintChanges(const Journal& journal, const std::vector<int>& cycles) {
  if (cycles.size() < 2) return;
  const std::vector<Result> first = journal.Results(cycles.front(), 0);
  const std::vector<Result> last = journal.Results(cycles.back(), 0);
  bool is_first = true;
  for (const auto& column : kColumns) {
    const auto before = FindResult(first, column.name);
    const auto after = FindResult(last, column.name);
    const auto gauge = journal.FindCalibration(fmt::format("{}{}", kRepeatabilityLimitPrefix, column.name));
    if (!before || !after || !gauge) continue;
    const int decimals = column.units().decimals + 1;
    const double change = after->value - before->value;
    const double limit = gauge->value;
    if (std::isnan(change)) continue;
    if (std::exchange(is_first, false)) {
      ToStdout("\nchange from cycle {} to {}, beside the repeatability limit of one difference (95 %)\n",
               cycles.front(), cycles.back());
    }
    ToStdout("  {:22} {:>+12.{}f}   gauge {:>10.{}f}   {}\n", column.name, change, decimals, limit, decimals,
             std::abs(change) > limit ? "larger than the gauge" : "within the gauge");
  }
}

void PrintMethods(const Journal& journal, const std::vector<int>& cycles) {
  if (cycles.empty()) return;
  const std::vector<Result> results = journal.Results(cycles.back(), 0);
  const bool has_loops = FindResult(results, quantities::kK1.name).has_value();
  if (!has_loops) return;
  ToStdout("\ncycle {}, three ways to read K from the same loops\n", cycles.back());
  for (const StiffnessMethod method : analysis::kStiffnessMethods) {
    const std::string_view name = NameOf(method);
    ToStdout("  {:18}", method == StiffnessMethod::kLoading ? "loading (secants)" : name);
    for (const analysis::Quantity& k : analysis::kStiffnesses) {
      const auto value =
          FindResult(results, method == CycleContext{}.method ? std::string(k.name) : NameByMethod(k, name));
      if (value && !std::isnan(value->value)) {
        ToStdout(" {:>9.0f} ± {:<5}", value->value, ErrorText(value->standard_error));
      } else {
        ToStdout(" {:>9}        ", "–");
      }
    }
    ToStdout("  {}\n", quantities::kK1.unit());
  }
}

nlohmann::json CampaignJson(const CampaignFolder& folder, const Journal& journal) {
  nlohmann::json cycles = nlohmann::json::array();
  for (const CycleRow& row : journal.Cycles()) {
    if (row.cycle > 0 && row.outcome == "complete")
      cycles.push_back(CycleJson(row.cycle, journal.Results(row.cycle, 0)));
  }
  return {{"kind", "campaign"}, {"folder", folder.root.string()}, {"cycles", std::move(cycles)}};
}

}  // namespace

std::string ValueCell(double value, int width, int decimals) {
  return std::isfinite(value) ? fmt::format("{:>{}.{}f}", value, width, decimals)
                              : fmt::format("{:>{}}", "–", width);
}

std::string ColumnTitle(const analysis::Quantity& quantity) {
  const std::string_view unit = quantity.unit() == "arcmin" ? "'" : quantity.unit();
  return quantity.symbol.empty() ? std::string(unit) : fmt::format("{} {}", quantity.symbol, unit);
}

nlohmann::json CycleJson(int cycle, const std::vector<Result>& results) {
  nlohmann::json row{{"cycle", cycle}};
  nlohmann::json flags = nlohmann::json::object();
  for (const Result& result : results) {
    row[result.quantity] = result.value;
    if (result.standard_error > 0.0) row[result.quantity + "_se"] = result.standard_error;
    if (!result.flag.empty()) flags[result.quantity] = result.flag;
  }
  row["flags"] = std::move(flags);
  return row;
}

int PrintCampaign(const CampaignFolder& folder, const Journal& journal, bool json) {
  if (json) {
    ToStdout("{}\n", CampaignJson(folder, journal).dump(2));
    return 0;
  }
  const std::vector<int> complete = CompleteCycles(journal.Cycles());
  const std::vector<int> cycles = CyclesShown(complete);
  if (cycles.empty()) {
    ToStdout("no cycle is complete yet\ncampaign: {}\n", folder.root.string());
    return 0;
  }
  PrintTable(journal, cycles);
  if (cycles.size() < complete.size()) {
    ToStdout("{} of {} cycles are shown: the first, the last, and as many between; all of them with --json\n",
             cycles.size(), complete.size());
  }
  PrintChanges(journal, cycles);
  PrintMethods(journal, cycles);
  const std::vector<Hole> holes = journal.Holes();
  const double longest_pause_s = ReadFrozenInputs(folder, journal).schedule.resume.longest_pause_s;
  ToStdout(
      "\n{} interruption(s), each in the journal's table holes; after a pause of up to {} it counts as the "
      "same "
      "test\n",
      holes.size(), DurationText(longest_pause_s));
  ToStdout("\n");
  try {
    for (const auto& picture : DrawCampaign(folder, journal, folder.Pictures())) {
      ToStdout("picture: {}.svg (and .png)\n", picture.string());
    }
  } catch (const GnuplotError& error) {
    ToStderr("no pictures: {}\n", error.what());
  }
  ToStdout("campaign: {}\n", folder.root.string());
  return 0;
}

}  // namespace strainwave::bench
