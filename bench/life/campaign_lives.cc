// SPDX-License-Identifier: Apache-2.0
#include "bench/life/campaign_lives.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "bench/campaign/campaign.h"
#include "bench/campaign/quality.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

namespace reliability = analysis::reliability;

constexpr std::size_t kTrendSteps = 20;

// What two campaigns must have alike: all but who is tested, the name and how many cycles.
std::string Comparable(const std::string& schedule) {
  std::string kept;
  std::istringstream lines(schedule);
  for (std::string line; std::getline(lines, line);) {
    line = line.substr(0, line.find('#'));
    while (!line.empty() && line.back() == ' ') line.pop_back();
    const std::size_t start = line.find_first_not_of(' ');
    if (start == std::string::npos) continue;
    const std::string_view key = std::string_view(line).substr(start);
    if (key.starts_with("identity:") || key.starts_with("cycles:") || key.starts_with("name:")) continue;
    kept += line + '\n';
  }
  return kept;
}

struct ReadCampaign {
  CampaignLife life;
  std::string schedule;
  std::uint64_t identity{};
};

ReadCampaign ReadOne(const std::string& path, const LifeSettings& settings, const LimitShares& shares,
                     std::vector<std::string>& warnings) {
  const CampaignFolder folder{path};
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
  for (const std::string& warning : WarningsAbout(folder, journal)) warnings.push_back(warning);
  const CampaignInputs inputs = ReadFrozenInputs(folder, journal);
  ReadCampaign one{{path, inputs.schedule.specimen.identity, journal.LastCompleteCycle(), {}, {}},
                   Comparable(inputs.schedule_text),
                   journal.Identity()};
  const std::map<std::string, ResultSeries> all = ResultSeriesOf(journal);
  const std::optional<double> first_k2 = FirstK2_Nm_per_rad(journal);
  if (one.life.cycles < static_cast<int>(kFewestCyclesOfTrend))
    Refuse(path, fmt::format("has {} complete cycles", std::max(one.life.cycles, 0)),
           fmt::format("{} at least, for a trend", kFewestCyclesOfTrend));
  for (const auto& [name, share] : shares) {
    if (!all.contains(name))
      Refuse(path, fmt::format("has no results of {}", name),
             "a quantity of it; strainwave table lists them");
  }
  for (const auto& [name, series] : all) {
    if (series.value.size() < kFewestCyclesOfTrend) continue;
    one.life.trends[name] = reliability::Binned({series.cycle, series.value}, kTrendSteps).way;
    std::optional<double> limit;
    if (const auto stop = StopLimitOf(inputs.schedule.stop, first_k2, name)) limit = stop->limit;
    if (const auto share = shares.find(name); share != shares.end()) limit = share->second * series.AtFirst();
    if (limit) one.life.limits.push_back(LimitOf(name, series, *limit, settings.level));
  }
  return one;
}

// Of all campaigns that have the limit of one quantity.
std::optional<QuantityLife> LifeByQuantity(const std::string& quantity, CampaignsReport& report) {
  std::vector<reliability::DegradationPath> paths;
  for (const CampaignLife& campaign : report.campaigns) {
    for (const CampaignLimit& limit : campaign.limits) {
      if (limit.quantity == quantity) paths.push_back(limit.path);
    }
  }
  QuantityLife life{quantity, {}, {}};
  try {
    life.life = reliability::LifeFromDegradation(paths, report.settings.shares, report.settings.level);
  } catch (const reliability::NoEstimate& error) {
    report.warnings.push_back(
        fmt::format("{}: no life of others: {} (expected {})", quantity, error.what(), error.expected()));
    return std::nullopt;
  }
  std::vector<reliability::Lifetime> pseudo;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const double cycle = life.life.pseudo_failures[i];
    pseudo.push_back(std::isfinite(cycle) && cycle > 0.0
                         ? reliability::Lifetime::Failed(cycle)
                         : reliability::Lifetime::Suspended(paths[i].cycle.back()));
  }
  try {
    life.pseudo = WeibullReportOf(pseudo, report.settings);
  } catch (const reliability::NoEstimate& error) {
    report.warnings.push_back(fmt::format("{}: no law of pseudo-failures: {}", quantity, error.what()));
  }
  return life;
}

void RankFeatures(CampaignsReport& report) {
  for (const auto& [name, trend] : report.campaigns.front().trends) {
    std::vector<std::vector<double>> units;
    for (const CampaignLife& campaign : report.campaigns) {
      if (const auto found = campaign.trends.find(name); found != campaign.trends.end())
        units.push_back(found->second);
    }
    if (units.size() == report.campaigns.size())
      report.features.push_back({name, reliability::WorthOf(units)});
  }
  std::ranges::stable_sort(report.features, std::greater{},
                           [](const RankedFeature& feature) { return feature.worth.sum(); });
}

}  // namespace

CampaignsReport LivesOfCampaigns(const std::vector<std::string>& folders, const LifeSettings& settings,
                                 const LimitShares& shares, bool join) {
  CampaignsReport report;
  report.settings = settings;
  std::string schedule;
  std::map<std::uint64_t, std::string> campaigns;  // folders by identity
  std::set<std::string> quantities;
  std::set<std::string> specimens;
  for (const std::string& folder : folders) {
    ReadCampaign one = ReadOne(folder, settings, shares, report.warnings);
    const auto [same, is_new] = campaigns.emplace(one.identity, folder);
    if (!is_new)
      Refuse(folder, fmt::format("is the campaign of {} again", same->second), "each campaign once");
    if (report.campaigns.empty()) schedule = one.schedule;
    if (one.schedule != schedule) {
      if (!join)
        Refuse(folder, fmt::format("its schedule differs from that of {}", folders.front()),
               "the same but for specimen, name and cycles, or --join");
      report.warnings.push_back(
          fmt::format("{}: its schedule differs from that of {}: joined as asked", folder, folders.front()));
    }
    if (!specimens.insert(one.life.specimen).second)
      report.warnings.push_back(
          fmt::format("{}: specimen {} is in two campaigns: it counts as two", folder, one.life.specimen));
    for (const CampaignLimit& limit : one.life.limits) quantities.insert(limit.quantity);
    report.campaigns.push_back(std::move(one.life));
  }
  if (quantities.empty())
    report.warnings.push_back(
        "no limit to forecast: the schedule has no stop criterion that is measured, and there is no --limit");
  for (const std::string& quantity : quantities) {
    if (auto life = LifeByQuantity(quantity, report)) report.lives.push_back(std::move(*life));
  }
  RankFeatures(report);
  return report;
}

}  // namespace strainwave::bench
