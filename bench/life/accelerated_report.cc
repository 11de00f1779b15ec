// SPDX-License-Identifier: Apache-2.0
#include "bench/life/accelerated_report.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

namespace reliability = analysis::reliability;
using reliability::ExponentPrior;

constexpr double kTorqueExponent = 3.0;
constexpr double kTorqueDeviation = 1.0;
constexpr double kSpeedExponent = 1.0;
constexpr double kSpeedDeviation = 0.5;

ExponentPrior PriorOf(Exponents exponents, double mean, double deviation) {
  switch (exponents) {
    case Exponents::kPrior:
      return {mean, deviation};
    case Exponents::kCatalogue:
      return {mean, 0.0};
    case Exponents::kFitted:
      return {mean, reliability::kNever};
  }
  return {};
}

std::string StressRow(const std::string& name, const reliability::BoundedEstimate& estimate,
                      const LifeSettings& settings, const std::string& unit) {
  const reliability::Interval shown = ShownOf(estimate, settings.bounds);
  const auto number = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.5g}", value) : "no bound";
  };
  return fmt::format("  {:16} {:>11} {:>12} {:>12}  {}\n", name, number(estimate.value), number(shown.low),
                     number(shown.high), unit);
}

}  // namespace

AcceleratedReport AcceleratedReportOf(const TimesTable& table, const LifeSettings& settings,
                                      const UseLoad& use) {
  AcceleratedReport report{use, table.unit, settings, {}, {}, table.warnings};
  std::vector<ExponentPrior> priors;
  const auto take = [&](const char* name, const char* column, bool has, const std::optional<double>& at,
                        double mean, double deviation) {
    if (!at) return;
    if (!has)
      Refuse(table.path, fmt::format("has no column {}", column),
             "the load of each unit, or of each of its steps");
    report.stresses.emplace_back(name);
    priors.push_back(PriorOf(use.exponents, mean, deviation));
  };
  take("torque", "torque_Nm", table.has_torque, use.torque_Nm, kTorqueExponent, kTorqueDeviation);
  take("speed", "speed_rpm", table.has_speed, use.speed_rpm, kSpeedExponent, kSpeedDeviation);
  std::vector<reliability::StressedLife> lives;
  for (const TimesRow& row : table.rows) {
    reliability::StressedLife life{row.life, {}};
    for (const LoadStep& step : row.steps) {
      reliability::StressStep stressed{step.end, {}};
      if (use.torque_Nm) stressed.log_stress.push_back(std::log(step.torque_Nm / *use.torque_Nm));
      if (use.speed_rpm) stressed.log_stress.push_back(std::log(step.speed_rpm / *use.speed_rpm));
      life.steps.push_back(stressed);
    }
    lives.push_back(life);
  }
  for (std::size_t j = 0; j < priors.size(); ++j) {
    if (use.exponents == Exponents::kPrior && reliability::IsConstant(lives, j))
      report.warnings.push_back(
          fmt::format("{} is the same in all steps of all units: its exponent is the catalogue's alone",
                      report.stresses[j]));
  }
  if (table.modes.size() > 1) report.warnings.push_back("with a load of use, modes are not told apart");
  if (settings.shape)
    report.warnings.push_back("with a load of use, --shape is not taken: the shape is fitted");
  try {
    report.fit = reliability::FitAccelerated(lives, priors, settings.shares, settings.level, report.stresses);
  } catch (const reliability::NoEstimate& error) {
    Refuse(table.path, error.what(), error.expected());
  }
  return report;
}

std::string TextOf(const AcceleratedReport& report) {
  std::string load;
  if (report.use.torque_Nm) load += fmt::format(" {:g} Nm", *report.use.torque_Nm);
  if (report.use.speed_rpm) load += fmt::format(" {:g} rpm", *report.use.speed_rpm);
  std::string text = fmt::format(
      "{:g} units, {:g} failed, times in {}\n\nWeibull of the time at{} that does equal damage (inverse "
      "power, steps by "
      "cumulative damage)\n  {:16} {:>11} {:>12} {:>12}\n",
      report.fit.counts.units, report.fit.counts.failures, report.unit, load, "", "likeliest",
      fmt::format("{:g} % from", 100.0 * report.settings.level), "to");
  for (std::size_t j = 0; j < report.stresses.size(); ++j)
    text += StressRow(report.stresses[j] + " exponent", report.fit.exponents[j], report.settings, "");
  text += StressRow("shape", report.fit.shape, report.settings, "");
  for (std::size_t i = 0; i < report.settings.shares.size(); ++i)
    text += StressRow(QuantileName(report.settings.shares[i]), report.fit.quantiles[i], report.settings,
                      report.unit);
  return text +
         (report.settings.bounds == LifeBounds::kFisher ? "bounds: Fisher\n" : "bounds: likelihood ratio\n");
}

nlohmann::ordered_json JsonOf(const AcceleratedReport& report) {
  const LifeBounds bounds = report.settings.bounds;
  nlohmann::ordered_json json{{"kind", "accelerated"},
                              {"time_unit", report.unit},
                              {"units", report.fit.counts.units},
                              {"failures", report.fit.counts.failures},
                              {"level", report.settings.level},
                              {"shape", JsonOf(report.fit.shape, bounds)}};
  if (report.use.torque_Nm) json["use"]["torque_Nm"] = *report.use.torque_Nm;
  if (report.use.speed_rpm) json["use"]["speed_rpm"] = *report.use.speed_rpm;
  for (std::size_t j = 0; j < report.stresses.size(); ++j)
    json["exponents"][report.stresses[j]] = JsonOf(report.fit.exponents[j], bounds);
  for (std::size_t i = 0; i < report.settings.shares.size(); ++i)
    json["quantiles"][QuantileName(report.settings.shares[i])] = JsonOf(report.fit.quantiles[i], bounds);
  json["warnings"] = report.warnings;
  return json;
}

}  // namespace strainwave::bench
