// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/reliability/degradation.h"
#include "analysis/reliability/prognostic_features.h"
#include "bench/life/stop_forecasts.h"
#include "bench/life/times_report.h"

namespace strainwave::bench {

/// A limit of a quantity as a share of its first values, beside the schedule's stop criteria.
using LimitShares = std::map<std::string, double>;

struct CampaignLife {
  std::string folder;
  std::string specimen;
  int cycles{};  // complete
  std::vector<CampaignLimit> limits;
  std::map<std::string, std::vector<double>> trends;  // each quantity, averaged to even steps
};

/// Life of the specimens' population by one quantity.
struct QuantityLife {
  std::string quantity;
  analysis::reliability::DegradationLife life;
  /// The Weibull law of the pseudo-failures, beside it.
  std::optional<WeibullReport> pseudo;
};

struct RankedFeature {
  std::string quantity;
  analysis::reliability::PrognosticWorth worth;
};

struct CampaignsReport {
  LifeSettings settings;
  std::vector<CampaignLife> campaigns;
  std::vector<QuantityLife> lives;
  std::vector<RankedFeature> features;  // the best first
  std::vector<std::string> warnings;
};

/// @param join  also where schedules differ in more than specimen, name and number of cycles.
/// @throws BenchError (exit code 2) for a campaign without cycles, schedules that differ, a limit that is
/// none.
CampaignsReport LivesOfCampaigns(const std::vector<std::string>& folders, const LifeSettings& settings,
                                 const LimitShares& shares, bool join);

std::string TextOf(const CampaignsReport& report);
nlohmann::ordered_json JsonOf(const CampaignsReport& report);

/// Each limit's way from 0 to 1 over cycles, with where it is forecast to be met. @throws GnuplotError.
std::filesystem::path DrawForecasts(const CampaignsReport& report, const std::filesystem::path& stem);

}  // namespace strainwave::bench
