// SPDX-License-Identifier: Apache-2.0
#include "bench/report/campaign_sheet.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "analysis/quantities.h"
#include "bench/campaign/cycle_context.h"
#include "bench/campaign/cycle_curves.h"
#include "bench/campaign/cycle_table.h"
#include "bench/campaign/pictures.h"
#include "bench/errors/bench_error.h"
#include "bench/integrity/campaign_integrity.h"
#include "bench/plots/gnuplot.h"
#include "bench/report/svg_text.h"
#include "daq/data_file_error.h"
#include "daq/record_error.h"

namespace strainwave::bench {
namespace {

constexpr const char* kProperties[] = {"started_utc",  "schedule_name",       "schedule_sha256",
                                       "bench_sha256", "commissioned_sha256", "plant_sha256",
                                       "specimen"};

void TakeResults(const Journal& journal, CampaignSheet& sheet) {
  journal.ForEachResult("", [&](const CycleResult& row) {
    if (!std::isfinite(row.result.value)) return true;
    QuantitySeries& series = sheet.series[row.result.quantity];
    series.cycle.push_back(row.cycle);
    series.value.push_back({row.result.value, row.result.standard_error});
    series.flag.push_back(row.result.flag);
    return true;
  });
  std::vector<std::string> quantities;
  for (const auto& [quantity, series] : sheet.series) quantities.push_back(quantity);
  sheet.control_limits = BaselineLimitsOf(journal, quantities);
  const std::string prefix(kRepeatabilityLimitPrefix);
  for (const Calibration& limit : journal.CalibrationsLike(prefix))
    sheet.repeatability_limits[limit.name.substr(prefix.size())] = limit.value;
}

void TakeHistory(const Journal& journal, CampaignSheet& sheet) {
  sheet.events = journal.Events(INT_MAX);
  std::ranges::reverse(sheet.events);
  sheet.notes = journal.OperatorNotes(INT_MAX);
  std::ranges::reverse(sheet.notes);
  sheet.holes = journal.Holes();
  sheet.samples = SamplesOf(journal);
  sheet.alarms = journal.Alarms(-1.0);
  sheet.alarm_actions = journal.AlarmActions();
  sheet.trail = TrailOf(journal);
  sheet.cut = CutPhasesOf(journal);
}

void TakeOrders(const analysis::SweepError& first, const analysis::SweepError* last, CampaignSheet& sheet) {
  for (const analysis::OrderLine& order : first.orders) {
    std::optional<analysis::OrderLine> after;
    if (last != nullptr) {
      const auto same = std::ranges::find(last->orders, order.order_per_output_rev,
                                          &analysis::OrderLine::order_per_output_rev);
      if (same != last->orders.end()) after = *same;
    }
    sheet.orders.emplace_back(order, after);
  }
}

const analysis::SweepError* SweepOf(const CycleCurves& curves) {
  const auto& error = curves.analysis.transmission_error;
  if (!error) return nullptr;
  return error->cw ? &*error->cw : &*error->ccw;
}

void TakeCurves(const CampaignFolder& folder, const Journal& journal, CampaignSheet& sheet) {
  const CycleContext context = ContextOf(journal, sheet.inputs.schedule, sheet.inputs.bench);
  std::vector<int> cycles;
  for (const CycleRow& row : journal.Cycles()) {
    if (row.cycle > 0 && row.outcome == "complete") cycles.push_back(row.cycle);
  }
  const CycleCurves first = ReadCycleCurves(folder, journal, cycles.front(), context);
  if (const auto* sweep = SweepOf(first); sweep != nullptr) {
    const CycleCurves last = ReadCycleCurves(folder, journal, cycles.back(), context);
    TakeOrders(*sweep, cycles.size() > 1 ? SweepOf(last) : nullptr, sheet);
  }
  const ScratchFolder scratch;
  for (const std::filesystem::path& picture : DrawCampaign(folder, journal, scratch.path())) {
    // Behind the campaign's own name, which may be anything.
    const std::string name = picture.filename().string().substr(sheet.name.size());
    if (name.ends_with("_transmission_error")) sheet.transmission_error_svg = SvgText(picture);
    if (name.find("_hysteresis") != std::string::npos) sheet.hysteresis_svg = SvgText(picture);
  }
}

// A page without pictures is better than none.
void TryToTakeCurves(const CampaignFolder& folder, const Journal& journal, CampaignSheet& sheet,
                     std::vector<std::string>& warnings) {
  try {
    TakeCurves(folder, journal, sheet);
  } catch (const GnuplotError& error) {
    sheet.no_pictures = error.what();
  } catch (const BenchError& error) {
    sheet.no_pictures = error.what();
  } catch (const daq::RecordError& error) {
    sheet.no_pictures = error.what();
  } catch (const daq::DataFileError& error) {
    sheet.no_pictures = error.what();
  }
  if (!sheet.no_pictures.empty())
    warnings.push_back(fmt::format("warning: no loops and no error over a turn: {}", sheet.no_pictures));
}

void TakeForecasts(double level, CampaignSheet& sheet) {
  LifeSettings settings;
  settings.level = level;
  try {
    CampaignsReport report = LivesOfCampaigns({sheet.folder}, settings, {}, false);
    sheet.limits = std::move(report.campaigns.front().limits);
  } catch (const BenchError& error) {
    const std::string words = error.what();
    const std::string mark = ": error: ";
    const std::size_t at = words.find(mark);
    sheet.no_forecast = at == std::string::npos ? words : "the campaign " + words.substr(at + mark.size());
  }
}

// Of the preparation, too: what is no cycle in a series.
std::map<std::string, std::pair<double, int>> EquivalentTimes(const Journal& journal,
                                                              const CampaignSheet& sheet) {
  constexpr std::string_view kEnd = "_equivalent_s";
  std::map<std::string, std::pair<double, int>> times;
  const auto take = [&](const std::string& quantity, double value_s) {
    if (!quantity.ends_with(kEnd)) return;
    auto& [sum_s, count] = times[quantity.substr(0, quantity.size() - kEnd.size())];
    sum_s += value_s;
    ++count;
  };
  for (const auto& [quantity, series] : sheet.series) {
    for (const analysis::Estimate& value : series.value) take(quantity, value.value);
  }
  for (const Result& result : journal.Results(0, 0)) take(result.quantity, result.value);
  return times;
}

// From files that are known to be whole.
void TakeLoad(const CampaignFolder& folder, const std::vector<int>& cycles, CampaignSheet& sheet,
              std::vector<std::string>& warnings) {
  try {
    sheet.load = ReadLoadHistory(folder, sheet.integrity, sheet.inputs.schedule, cycles);
  } catch (const daq::RecordError& error) {
    warnings.push_back(fmt::format("warning: the load's ranges are not counted: {}", error.what()));
  }
}

std::string VerifiedLine(const CampaignIntegrity& integrity) {
  const ChainReport& chain = integrity.journal.chain;
  return fmt::format("{}: journal {}, {}, {} complete cycles; files: {} whole, {} damaged, {} missing.",
                     Name(integrity.verdict()), Name(integrity.journal.state),
                     integrity.journal.has_chain
                         ? fmt::format("chain of {} links {}, head {}", chain.links,
                                       chain.IsWhole() ? "whole" : "broken", chain.head)
                         : "no chain, since it is of an earlier version",
                     integrity.cycles, integrity.Count(FileState::kWhole),
                     integrity.Count(FileState::kDamaged), integrity.Count(FileState::kMissing));
}

bool IsOfAnotherMethod(const std::string& quantity) {
  for (const analysis::Quantity& k : analysis::kStiffnesses) {
    for (const analysis::StiffnessMethod method : analysis::kStiffnessMethods) {
      if (quantity == NameByMethod(k, NameOf(method))) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::string> MainQuantities(const CampaignSheet& sheet) {
  std::vector<std::string> names;
  for (const analysis::Quantity& quantity : analysis::kQuantities) {
    if (sheet.series.contains(std::string(quantity.name))) names.emplace_back(quantity.name);
  }
  for (const auto& [name, series] : sheet.series) {
    if (analysis::FindQuantity(name) == nullptr && !IsOfAnotherMethod(name) && !name.starts_with("samples_"))
      names.push_back(name);
  }
  return names;
}

std::string HeadOf(const std::string& quantity) {
  const analysis::Quantity* const known = analysis::FindQuantity(quantity);
  std::string words(known == nullptr ? analysis::WithoutUnit(quantity) : known->title);
  std::ranges::replace(words, '_', ' ');
  const std::string_view unit = analysis::UnitOf(quantity);
  return unit.empty() ? words : fmt::format("{} ({})", words, unit);
}

CampaignSheet ReadCampaignSheet(const std::string& path, double level, std::vector<std::string>& warnings) {
  CampaignSheet sheet;
  sheet.folder = path;
  sheet.name = std::filesystem::weakly_canonical(path).filename().string();
  const CampaignFolder folder{path};
  std::vector<int> cycles;
  {
    const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
    for (const std::string& warning : WarningsAbout(folder, journal)) warnings.push_back(warning);
    sheet.complete = std::max(0, journal.LastCompleteCycle());
    if (sheet.complete < 1)
      Refuse(folder.root, "has no complete cycle yet", "one at least; strainwave status shows how far it is");
    sheet.inputs = ReadFrozenInputs(folder, journal);
    for (const char* const key : kProperties) sheet.properties[key] = journal.Property(key).value_or("");
    sheet.bench_time_s = journal.LatestTime_s();
    sheet.load_s = journal.CreditedLoad_s(0);
    TakeHistory(journal, sheet);
    TakeResults(journal, sheet);
    for (const CycleRow& row : journal.Cycles()) {
      if (row.outcome == "complete") cycles.push_back(row.cycle);
    }
    sheet.load_runs = LoadRunShares(sheet.inputs.schedule, sheet.complete, EquivalentTimes(journal, sheet));
    sheet.cycles_csv = CycleTableOf(journal).csv;
    sheet.checks = CheckHistories(sheet.inputs.schedule, CheckResultsIn(journal, sheet.inputs.schedule));
    sheet.first_k2_Nm_per_rad = FirstK2_Nm_per_rad(journal);
    sheet.stops = StopDistances(sheet.inputs.schedule.stop, sheet.first_k2_Nm_per_rad,
                                journal.Results(sheet.complete, 0));
    TryToTakeCurves(folder, journal, sheet, warnings);
  }
  // Each opens the journal itself, which must be closed here by then (`Journal::Open`).
  TakeForecasts(level, sheet);
  sheet.integrity = VerifyCampaign(folder, [](std::uint64_t, std::uint64_t) {});
  sheet.verified = VerifiedLine(sheet.integrity);
  TakeLoad(folder, cycles, sheet, warnings);
  return sheet;
}

}  // namespace strainwave::bench
