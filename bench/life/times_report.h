// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/reliability/competing_modes.h"
#include "analysis/reliability/weibayes.h"
#include "analysis/reliability/weibull_fit.h"
#include "analysis/reliability/weibull_three.h"
#include "bench/life/times_file.h"

namespace strainwave::bench {

/// Which interval is shown first; JSON has them all.
enum class LifeBounds { kCorrected, kLikelihoodRatio, kFisher };

struct LifeSettings {
  double level{0.9};
  std::vector<double> shares{0.1, 0.5};  // that have failed: B10, B50
  std::vector<double> at;                // times to tell the survival of, in the unit of the table
  std::optional<double> shape;           // known from elsewhere: Weibayes
  bool three_parameters{};
  LifeBounds bounds{LifeBounds::kCorrected};
};

struct Quantile {
  double share_failed{};
  analysis::reliability::BoundedEstimate life;
};

struct SurvivalAt {
  double time{};
  analysis::reliability::BoundedEstimate survival;
};

struct WeibullReport {
  analysis::reliability::WeibullFit fit;
  analysis::reliability::WeibullBounds bounds;
  std::vector<Quantile> quantiles;
  std::vector<SurvivalAt> survival;
};

struct WeibayesReport {
  double share_failed{};
  analysis::reliability::Weibayes fit;
  std::vector<analysis::reliability::Weibayes> sensitivity;
};

struct ThreeReport {
  analysis::reliability::WeibullThreeFit fit;
  double share_failed{};
  analysis::reliability::WeibullThreeBounds bounds;
};

struct ModesReport {
  std::vector<std::string> names;
  std::vector<WeibullReport> modes;
  std::vector<Quantile> system;
};

/// What a table of times says: one of the four.
struct TimesReport {
  std::string unit;
  analysis::reliability::LifetimeCounts counts;
  LifeSettings settings;
  std::vector<analysis::reliability::Lifetime> lifetimes;
  std::optional<WeibullReport> weibull;
  std::optional<WeibayesReport> weibayes;
  std::optional<ThreeReport> three;
  std::optional<ModesReport> modes;
  std::vector<std::string> warnings;
};

/// @throws BenchError (exit code 2) where the table cannot give what is asked, with what could.
TimesReport ReportOf(const TimesTable& table, const LifeSettings& settings);

WeibullReport WeibullReportOf(const std::vector<analysis::reliability::Lifetime>& lives,
                              const LifeSettings& settings);

/// The interval that is shown.
analysis::reliability::Interval ShownOf(const analysis::reliability::BoundedEstimate& estimate,
                                        LifeBounds bounds);
/// "B10", "B0.1".
std::string QuantileName(double share_failed);
/// The shape that the maker's L10 and L50 have.
double CatalogueShape();

std::string TextOf(const TimesReport& report);
nlohmann::ordered_json JsonOf(const TimesReport& report);
nlohmann::ordered_json JsonOf(const analysis::reliability::BoundedEstimate& estimate, LifeBounds bounds);

}  // namespace strainwave::bench
