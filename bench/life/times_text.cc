// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/life/times_report.h"

namespace strainwave::bench {
namespace {

namespace reliability = analysis::reliability;
using nlohmann::ordered_json;
using reliability::BoundedEstimate, reliability::Interval;

std::string Number(double value) { return std::isfinite(value) ? fmt::format("{:.5g}", value) : "no bound"; }

std::string_view BoundsName(LifeBounds bounds) {
  switch (bounds) {
    case LifeBounds::kCorrected:
      return "likelihood ratio, corrected for few failures";
    case LifeBounds::kLikelihoodRatio:
      return "likelihood ratio";
    case LifeBounds::kFisher:
      return "Fisher";
  }
  return "";
}

std::string_view BoundsKey(LifeBounds bounds) {
  switch (bounds) {
    case LifeBounds::kCorrected:
      return "corrected";
    case LifeBounds::kLikelihoodRatio:
      return "likelihood_ratio";
    case LifeBounds::kFisher:
      return "fisher";
  }
  return "";
}

std::string Row(const std::string& name, const BoundedEstimate& estimate, const std::string& unit,
                LifeBounds bounds) {
  const Interval shown = ShownOf(estimate, bounds);
  return fmt::format("  {:14} {:>11} {:>12} {:>12}   {:>11}  {}\n", name, Number(estimate.value),
                     Number(shown.low), Number(shown.high), Number(estimate.median_unbiased), unit);
}

std::string HeaderOf(const LifeSettings& settings) {
  return fmt::format("  {:14} {:>11} {:>12} {:>12}   {:>11}\n", "", "likeliest",
                     fmt::format("{:g} % from", 100.0 * settings.level), "to", "unbiased");
}

std::string WeibullRows(const WeibullReport& report, const std::string& unit, const LifeSettings& settings) {
  std::string text = Row("shape", report.bounds.shape, "", settings.bounds) +
                     Row("scale", report.bounds.scale, unit, settings.bounds);
  for (const Quantile& quantile : report.quantiles)
    text += Row(QuantileName(quantile.share_failed), quantile.life, unit, settings.bounds);
  for (const SurvivalAt& at : report.survival)
    text += Row(fmt::format("R({:g} {})", at.time, unit), at.survival, "", settings.bounds);
  return text;
}

std::string BoundsLine(const LifeSettings& settings) {
  return fmt::format("bounds: {}; each end alone holds with {:g} %\n", BoundsName(settings.bounds),
                     50.0 * (1.0 + settings.level));
}

std::string WeibayesText(const WeibayesReport& report, const TimesReport& of) {
  const std::string name = QuantileName(report.share_failed);
  const double one_sided = 50.0 * (1.0 + of.settings.level);
  std::string text = fmt::format("Weibayes, shape {:g} as given\n", report.fit.shape);
  if (report.fit.quantile)
    text += fmt::format("  scale {} {}, {} {} {}\n", Number(*report.fit.scale), of.unit, name,
                        Number(*report.fit.quantile), of.unit);
  text +=
      fmt::format("  {} is at least {} {} with {:g} % confidence{}\n", name,
                  Number(report.fit.quantile_bounds.low), of.unit, one_sided,
                  report.fit.quantile ? fmt::format(", at most {}", Number(report.fit.quantile_bounds.high))
                                      : "; nothing failed, so it has no upper bound");
  text += fmt::format("what another shape would say\n  {:>8} {:>18}\n", "shape",
                      fmt::format("{} at least", name));
  for (const auto& other : report.sensitivity)
    text += fmt::format("  {:>8.3g} {:>18} {}\n", other.shape, Number(other.quantile_bounds.low), of.unit);
  return text;
}

std::string ThreeText(const ThreeReport& report, const TimesReport& of) {
  const auto row = [&](const std::string& name, double value, const Interval& interval,
                       const std::string& unit) {
    return fmt::format("  {:14} {:>11} {:>12} {:>12}   {}\n", name, Number(value), Number(interval.low),
                       Number(interval.high), unit);
  };
  std::string text = fmt::format("Weibull, three parameters\n  {:14} {:>11} {:>12} {:>12}\n", "", "likeliest",
                                 fmt::format("{:g} % from", 100.0 * of.settings.level), "to");
  text += row("shape", report.fit.shape, report.bounds.shape, "");
  text += fmt::format("  {:14} {:>11}   {:>26}{}\n", "scale", Number(report.fit.scale), "", of.unit);
  text += row("threshold", report.fit.threshold, report.bounds.threshold, of.unit);
  text += row(QuantileName(report.share_failed),
              reliability::WeibullThreeQuantile(report.fit, report.share_failed), report.bounds.quantile,
              of.unit);
  text += fmt::format("the threshold gains {:.2f} of log-likelihood over two parameters{}\n", report.fit.gain,
                      report.fit.gain < 1.35 ? ": no evidence for one (1.35 would be 95 %)" : "");
  return text + "bounds: likelihood ratio\n";
}

ordered_json IntervalJson(const Interval& interval) {
  const auto end = [](double value) {
    return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
  };
  return ordered_json::array({end(interval.low), end(interval.high)});
}

ordered_json QuantilesJson(const std::vector<Quantile>& quantiles, LifeBounds bounds) {
  ordered_json json = ordered_json::object();
  for (const Quantile& quantile : quantiles)
    json[QuantileName(quantile.share_failed)] = JsonOf(quantile.life, bounds);
  return json;
}

ordered_json WeibullJson(const WeibullReport& report, LifeBounds bounds) {
  ordered_json json{{"units", report.fit.counts.units},
                    {"failures", report.fit.counts.failures},
                    {"log_likelihood", report.fit.log_likelihood},
                    {"shape", JsonOf(report.bounds.shape, bounds)},
                    {"scale", JsonOf(report.bounds.scale, bounds)},
                    {"quantiles", QuantilesJson(report.quantiles, bounds)}};
  json["survival"] = ordered_json::array();
  for (const SurvivalAt& at : report.survival) {
    ordered_json row = JsonOf(at.survival, bounds);
    row["time"] = at.time;
    json["survival"].push_back(row);
  }
  return json;
}

ordered_json WeibayesJson(const reliability::Weibayes& fit, double share_failed) {
  const auto known = [](const std::optional<double>& value) {
    return value ? ordered_json(*value) : ordered_json(nullptr);
  };
  return {{"shape", fit.shape},
          {"scale", {{"value", known(fit.scale)}, {"interval", IntervalJson(fit.scale_bounds)}}},
          {QuantileName(share_failed),
           {{"value", known(fit.quantile)}, {"interval", IntervalJson(fit.quantile_bounds)}}}};
}

}  // namespace

ordered_json JsonOf(const BoundedEstimate& estimate, LifeBounds bounds) {
  const Interval shown = ShownOf(estimate, bounds);
  return {{"value", estimate.value},
          {"median_unbiased", estimate.median_unbiased},
          {"low", IntervalJson(shown)[0]},
          {"high", IntervalJson(shown)[1]},
          {"fisher", IntervalJson(estimate.fisher)},
          {"likelihood_ratio", IntervalJson(estimate.likelihood_ratio)},
          {"corrected", IntervalJson(estimate.corrected)}};
}

ordered_json JsonOf(const TimesReport& report) {
  const LifeBounds bounds = report.settings.bounds;
  ordered_json json{{"kind", "times"},
                    {"time_unit", report.unit},
                    {"units", report.counts.units},
                    {"failures", report.counts.failures},
                    {"level", report.settings.level},
                    {"bounds", BoundsKey(bounds)}};
  if (report.weibull) json["weibull"] = WeibullJson(*report.weibull, bounds);
  if (report.weibayes) {
    json["weibayes"] = WeibayesJson(report.weibayes->fit, report.weibayes->share_failed);
    for (const auto& other : report.weibayes->sensitivity)
      json["weibayes"]["sensitivity"].push_back(WeibayesJson(other, report.weibayes->share_failed));
  }
  if (report.three) {
    const ThreeReport& three = *report.three;
    json["weibull_three"] = {
        {"shape", {{"value", three.fit.shape}, {"interval", IntervalJson(three.bounds.shape)}}},
        {"scale", three.fit.scale},
        {"threshold", {{"value", three.fit.threshold}, {"interval", IntervalJson(three.bounds.threshold)}}},
        {QuantileName(three.share_failed),
         {{"value", reliability::WeibullThreeQuantile(three.fit, three.share_failed)},
          {"interval", IntervalJson(three.bounds.quantile)}}},
        {"log_likelihood", three.fit.log_likelihood},
        {"gain_over_two", three.fit.gain}};
  }
  if (report.modes) {
    for (std::size_t i = 0; i < report.modes->names.size(); ++i)
      json["modes"][report.modes->names[i]] = WeibullJson(report.modes->modes[i], bounds);
    json["system"] = QuantilesJson(report.modes->system, bounds);
  }
  json["warnings"] = report.warnings;
  return json;
}

std::string TextOf(const TimesReport& report) {
  const LifeSettings& settings = report.settings;
  std::string text = fmt::format("{:g} units, {:g} failed, times in {}\n\n", report.counts.units,
                                 report.counts.failures, report.unit);
  if (report.weibull)
    text += "Weibull, two parameters\n" + HeaderOf(settings) +
            WeibullRows(*report.weibull, report.unit, settings) + BoundsLine(settings);
  if (report.weibayes) text += WeibayesText(*report.weibayes, report);
  if (report.three) text += ThreeText(*report.three, report);
  if (report.modes) {
    for (std::size_t i = 0; i < report.modes->names.size(); ++i) {
      const WeibullReport& mode = report.modes->modes[i];
      text += fmt::format("mode {}: {:g} failed of it\n", report.modes->names[i], mode.fit.counts.failures) +
              HeaderOf(settings) + WeibullRows(mode, report.unit, settings);
    }
    text += "any of the modes\n" + HeaderOf(settings);
    for (const Quantile& quantile : report.modes->system)
      text += Row(QuantileName(quantile.share_failed), quantile.life, report.unit, settings.bounds);
    text += BoundsLine(settings);
  }
  return text;
}

}  // namespace strainwave::bench
