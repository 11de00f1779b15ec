// SPDX-License-Identifier: Apache-2.0
#include "bench/life/times_report.h"

#include <fmt/format.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

namespace reliability = analysis::reliability;
using reliability::BoundedEstimate, reliability::Lifetime;

constexpr double kFewFailures = 2.0;
constexpr double kEnoughForShape = 10.0;

ModesReport ModesReportOf(const TimesTable& table, const LifeSettings& settings) {
  std::vector<reliability::ModeLifetime> lives;
  for (const TimesRow& row : table.rows) lives.push_back({row.life, row.mode});
  const int count = static_cast<int>(table.modes.size());
  const reliability::CompetingModes fit = reliability::FitCompetingModes(lives, count, table.modes);
  ModesReport report;
  report.names = table.modes;
  for (int mode = 0; mode < count; ++mode)
    report.modes.push_back(WeibullReportOf(reliability::LivesOfMode(lives, mode), settings));
  for (const double share : settings.shares)
    report.system.push_back({share, reliability::BoundsOfSystemQuantile(fit, lives, share, settings.level)});
  return report;
}

WeibayesReport WeibayesReportOf(const std::vector<Lifetime>& lives, const LifeSettings& settings) {
  const double share = settings.shares.front();
  return {share, reliability::FitWeibayes(lives, *settings.shape, share, settings.level),
          reliability::WeibayesSensitivity(lives, *settings.shape, share, settings.level)};
}

void Fill(TimesReport& report, const TimesTable& table) {
  const LifeSettings& settings = report.settings;
  const std::vector<Lifetime>& lives = report.lifetimes;
  if (settings.shape) {
    report.weibayes = WeibayesReportOf(lives, settings);
    if (report.counts.failures >= kEnoughForShape)
      report.warnings.push_back(
          fmt::format("{:g} failures tell the shape themselves: the one that was given is taken",
                      report.counts.failures));
    if (!table.modes.empty()) report.warnings.push_back("with a shape given, modes are not told apart");
  } else if (table.modes.size() > 1) {
    report.modes = ModesReportOf(table, settings);
    if (settings.three_parameters) report.warnings.push_back("modes have two parameters each");
  } else if (settings.three_parameters) {
    const reliability::WeibullThreeFit fit = reliability::FitWeibullThree(lives);
    const double share = settings.shares.front();
    report.three = ThreeReport{fit, share, reliability::BoundsOfThree(fit, lives, share, settings.level)};
  } else {
    report.weibull = WeibullReportOf(lives, settings);
  }
  if (!settings.shape && report.counts.failures < kFewFailures)
    report.warnings.push_back(
        "one failure hardly tells a shape: take --shape, for Weibayes, where it is known from elsewhere");
}

}  // namespace

double CatalogueShape() {
  constexpr double kL10_h = 7000.0;
  constexpr double kL50_h = 35000.0;
  return reliability::ShapeOfQuantiles(0.1, kL10_h, 0.5, kL50_h);
}

WeibullReport WeibullReportOf(const std::vector<Lifetime>& lives, const LifeSettings& settings) {
  WeibullReport report;
  const reliability::BoundsSettings bounds{.level = settings.level};
  report.fit = reliability::FitWeibull(lives);
  report.bounds = reliability::BoundsOf(report.fit, lives, bounds);
  for (const double share : settings.shares)
    report.quantiles.push_back({share, reliability::BoundsOfQuantile(report.fit, lives, share, bounds)});
  for (const double time : settings.at)
    report.survival.push_back({time, reliability::BoundsOfSurvival(report.fit, lives, time, bounds)});
  return report;
}

TimesReport ReportOf(const TimesTable& table, const LifeSettings& settings) {
  TimesReport report;
  report.unit = table.unit;
  report.settings = settings;
  report.lifetimes = table.lifetimes();
  report.counts = reliability::CountLifetimes(report.lifetimes);
  report.warnings = table.warnings;
  try {
    Fill(report, table);
  } catch (const reliability::NoEstimate& error) {
    const bool asks_shape = error.expected().find("shape") != std::string::npos;
    Refuse(table.path, error.what(),
           asks_shape ? fmt::format("{}: --shape; the maker's L10 and L50 have {:.2f}", error.expected(),
                                    CatalogueShape())
                      : error.expected());
  } catch (const std::invalid_argument& error) {
    Refuse(table.path, error.what(), "times of units that ran");
  }
  return report;
}

reliability::Interval ShownOf(const BoundedEstimate& estimate, LifeBounds bounds) {
  switch (bounds) {
    case LifeBounds::kCorrected:
      return estimate.corrected;
    case LifeBounds::kLikelihoodRatio:
      return estimate.likelihood_ratio;
    case LifeBounds::kFisher:
      return estimate.fisher;
  }
  return estimate.corrected;
}

std::string QuantileName(double share_failed) { return fmt::format("B{:.6g}", 100.0 * share_failed); }

}  // namespace strainwave::bench
