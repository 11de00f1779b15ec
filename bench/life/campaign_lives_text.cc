// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/life/campaign_lives.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

using analysis::reliability::BoundedEstimate, analysis::reliability::Interval,
    analysis::reliability::LifeQuantile;
using nlohmann::ordered_json;

std::string Cycles(double value) { return std::isfinite(value) ? fmt::format("{:.0f}", value) : "never"; }

std::string ForecastText(const CampaignLimit& limit) {
  std::string text = fmt::format("  {:28} {:>10.5g} {:>10.5g} {:>10.5g}  ", limit.quantity, limit.first,
                                 limit.last, limit.limit);
  if (limit.met_at) return text + fmt::format("met at cycle {}\n", *limit.met_at);
  if (!limit.forecast.is_approached) return text + "not approached: no forecast\n";
  return text + fmt::format("at cycle {} ({} to {})\n", Cycles(limit.forecast.cycle),
                            Cycles(limit.forecast.interval.low), Cycles(limit.forecast.interval.high));
}

std::string CyclesRow(const std::string& name, double value, const Interval& interval) {
  return fmt::format("  {:28} {:>10} {:>10} {:>10}\n", name, Cycles(value), Cycles(interval.low),
                     Cycles(interval.high));
}

ordered_json KnownJson(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json QuantileJson(const LifeQuantile& quantile) {
  return {{"value", quantile.value}, {"low", quantile.interval.low}, {"high", quantile.interval.high}};
}

ordered_json LimitJson(const CampaignLimit& limit) {
  ordered_json json{
      {"quantity", limit.quantity}, {"first", limit.first}, {"last", limit.last}, {"limit", limit.limit}};
  json["met_at_cycle"] = limit.met_at ? ordered_json(*limit.met_at) : ordered_json(nullptr);
  json["approached"] = limit.met_at || limit.forecast.is_approached;
  if (!limit.forecast.is_approached) return json;
  json["forecast"] = {{"cycle", KnownJson(limit.forecast.cycle)},
                      {"low", KnownJson(limit.forecast.interval.low)},
                      {"high", KnownJson(limit.forecast.interval.high)}};
  return json;
}

}  // namespace

std::string TextOf(const CampaignsReport& report) {
  std::string text;
  for (const CampaignLife& campaign : report.campaigns) {
    text += fmt::format("{}: specimen {}, {} cycles\n  {:28} {:>10} {:>10} {:>10}  {}\n", campaign.folder,
                        campaign.specimen, campaign.cycles, "limit of", "first", "now", "limit",
                        fmt::format("met ({:g} %)", 100.0 * report.settings.level));
    for (const CampaignLimit& limit : campaign.limits) text += ForecastText(limit);
    if (campaign.limits.empty()) text += "  none\n";
  }
  for (const QuantityLife& life : report.lives) {
    text += fmt::format(
        "\nlife of others to the limit of {}, in cycles, from {} specimens (mixed effects)\n "
        " {:28} {:>10} {:>10} {:>10}\n",
        life.quantity, life.life.pseudo_failures.size(), "", "median",
        fmt::format("{:g} % from", 100.0 * report.settings.level), "to");
    for (std::size_t i = 0; i < report.settings.shares.size(); ++i) {
      const LifeQuantile& quantile = life.life.quantiles[i];
      text += CyclesRow(QuantileName(report.settings.shares[i]), quantile.value, quantile.interval);
      if (!life.pseudo) continue;
      const BoundedEstimate& pseudo = life.pseudo->quantiles[i].life;
      text +=
          CyclesRow("  by pseudo-failures, Weibull", pseudo.value, ShownOf(pseudo, report.settings.bounds));
    }
  }
  text +=
      fmt::format("\nwhich trends predict (Coble 2009; {} specimen{})\n  {:34} {:>12} {:>14} {:>12}\n",
                  report.campaigns.size(), report.campaigns.size() == 1 ? ": monotonicity alone tells" : "s",
                  "", "monotonicity", "prognosability", "trendability");
  constexpr std::size_t kShown = 12;
  for (std::size_t i = 0; i < std::min(kShown, report.features.size()); ++i) {
    const RankedFeature& feature = report.features[i];
    text += fmt::format("  {:34} {:>12.2f} {:>14.2f} {:>12.2f}\n", feature.quantity,
                        feature.worth.monotonicity, feature.worth.prognosability, feature.worth.trendability);
  }
  return text;
}

ordered_json JsonOf(const CampaignsReport& report) {
  ordered_json json{
      {"kind", "campaigns"}, {"level", report.settings.level}, {"campaigns", ordered_json::array()}};
  for (const CampaignLife& campaign : report.campaigns) {
    ordered_json one{{"folder", campaign.folder},
                     {"specimen", campaign.specimen},
                     {"cycles", campaign.cycles},
                     {"limits", ordered_json::array()}};
    for (const CampaignLimit& limit : campaign.limits) one["limits"].push_back(LimitJson(limit));
    json["campaigns"].push_back(one);
  }
  json["life"] = ordered_json::object();
  for (const QuantityLife& life : report.lives) {
    ordered_json one{{"log_life_deviation", QuantileJson(life.life.log_deviation)}};
    for (const double cycle : life.life.pseudo_failures) one["pseudo_failures"].push_back(KnownJson(cycle));
    for (std::size_t i = 0; i < report.settings.shares.size(); ++i) {
      const std::string name = QuantileName(report.settings.shares[i]);
      one["quantiles"][name] = QuantileJson(life.life.quantiles[i]);
      if (life.pseudo)
        one["by_pseudo_failures"][name] = JsonOf(life.pseudo->quantiles[i].life, report.settings.bounds);
    }
    json["life"][life.quantity] = one;
  }
  json["features"] = ordered_json::array();
  for (const RankedFeature& feature : report.features)
    json["features"].push_back({{"name", feature.quantity},
                                {"monotonicity", feature.worth.monotonicity},
                                {"prognosability", feature.worth.prognosability},
                                {"trendability", feature.worth.trendability}});
  json["warnings"] = report.warnings;
  return json;
}

std::filesystem::path DrawForecasts(const CampaignsReport& report, const std::filesystem::path& stem) {
  // The palette of Okabe and Ito, without its yellow, which paper does not show.
  constexpr std::array kColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000"};
  constexpr double kApart = 0.06;  // intervals stand one above the other over the limit
  std::string script;
  std::string plot;
  std::size_t number = 0;
  double top = 1.0;
  for (const CampaignLife& campaign : report.campaigns) {
    for (const CampaignLimit& limit : campaign.limits) {
      const auto shown = analysis::reliability::Binned(limit.path, 400);
      const std::string name = fmt::format("path{}", number);
      const std::string_view colour = kColours[number++ % kColours.size()];
      script += DataBlock(name, {shown.cycle, shown.way});
      plot +=
          fmt::format("{}${} using 1:2 with lines lw 1.5 lc rgb '{}' title {}", plot.empty() ? "plot " : ", ",
                      name, colour, Quoted(campaign.specimen + " " + limit.quantity));
      if (!limit.forecast.is_approached) continue;
      top += kApart;
      const double high = std::isfinite(limit.forecast.interval.high) ? limit.forecast.interval.high
                                                                      : 3.0 * limit.forecast.cycle;
      const std::vector<double> at{limit.forecast.cycle}, height{top}, low{limit.forecast.interval.low},
          until{high};
      const std::vector<double> way_cycle{shown.cycle.back(), limit.forecast.cycle},
          way{shown.way.back(), 1.0};
      script += DataBlock(name + "met", {at, height, low, until});
      script += DataBlock(name + "way", {way_cycle, way});
      plot += fmt::format(
          ", ${0}way using 1:2 with lines lw 1.2 dt 3 lc rgb '{1}' notitle"
          ", ${0}met using 1:2:3:4 with xerrorbars pt 7 lw 1.8 lc rgb '{1}' notitle",
          name, colour);
    }
  }
  script +=
      CommonStyle() +
      fmt::format("set xlabel 'cycle' offset 0,0.6\nset ylabel 'way to the limit'\nset yrange [*:{:.4g}]\n",
                  top + kApart) +
      "set key outside below\nset title 'way to each limit, and when it is forecast to be met (above the "
      "limit, with its interval)'\n";
  return RenderPicture(script + plot + ", 1 with lines dt 2 lc rgb '#444444' title 'limit'\n", stem,
                       {1000, 700});
}

}  // namespace strainwave::bench
