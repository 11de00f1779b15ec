// SPDX-License-Identifier: Apache-2.0
#include "bench/health/system_model.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/health/levels.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

namespace statistics = analysis::statistics;

// Means of the values of each unit in each condition.
std::vector<SystemValue> UnitMeans(const std::vector<SystemValue>& values) {
  std::map<std::pair<int, std::vector<double>>, std::pair<double, double>> sums;
  for (const SystemValue& value : values) {
    auto& [sum, count] = sums[{value.unit, {value.health.begin(), value.health.end()}}];
    sum += value.value;
    count += 1.0;
  }
  std::vector<SystemValue> means;
  for (const auto& [key, total] : sums)
    means.push_back(
        {Eigen::Map<const Eigen::VectorXd>(key.second.data(), static_cast<Eigen::Index>(key.second.size())),
         key.first, total.first / total.second});
  return means;
}

Eigen::MatrixXd PointsOf(const std::vector<SystemValue>& values) {
  Eigen::MatrixXd points(static_cast<Eigen::Index>(values.size()), values.front().health.size());
  for (std::size_t i = 0; i < values.size(); ++i) points.row(static_cast<Eigen::Index>(i)) = values[i].health;
  return points;
}

std::vector<double> NumbersOf(const std::vector<SystemValue>& values) {
  std::vector<double> numbers;
  for (const SystemValue& value : values) numbers.push_back(value.value);
  return numbers;
}

std::optional<statistics::VarianceTable> TableOf(const std::vector<SystemValue>& values,
                                                 const std::vector<std::string>& components,
                                                 const std::string& of, std::vector<std::string>& notes) {
  try {
    return statistics::AnalysisOfVariance(NumbersOf(values), analysis::health::LevelsOf(PointsOf(values)),
                                          components);
  } catch (const std::invalid_argument& error) {
    notes.push_back(fmt::format("no analysis of variance of {}: {}", of, error.what()));
    return std::nullopt;
  }
}

}  // namespace

std::optional<SystemModel> FitSystem(const HealthData& data, const SystemSettings& settings,
                                     std::vector<std::string>& notes) {
  if (data.system.empty()) {
    notes.push_back("system_rms was not measured: nothing is said of the system");
    return std::nullopt;
  }
  const std::vector<SystemValue> values = settings.unit_means ? UnitMeans(data.system) : data.system;
  const std::vector<double> numbers = NumbersOf(values);
  const statistics::ReplicatedData replicated = statistics::Replicated(
      PointsOf(values),
      Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size())));
  const auto distinct = replicated.points.rows();
  constexpr Eigen::Index kMostPoints = 1500;
  if (distinct > kMostPoints)
    Refuse(data.folder / "labels.csv",
           fmt::format("system_rms was measured at {} states of health", distinct),
           fmt::format("{} at most", kMostPoints));
  try {
    const auto fit = [&](bool one_length) {
      return statistics::FitGaussianProcess(
          replicated, {statistics::MeanOf::kConstant, one_length, settings.restarts, settings.seed});
    };
    statistics::GaussianProcess one = fit(true);
    statistics::GaussianProcess own = fit(false);
    const double one_log = one.log_likelihood();
    const double own_log = own.log_likelihood();
    const bool one_length = own_log - one_log <= static_cast<double>(data.components.size()) - 1.0;
    Eigen::Index worst = 0;
    replicated.means.maxCoeff(&worst);
    SystemModel model{one_length ? std::move(one) : std::move(own),
                      {},
                      {},
                      {},
                      one_length,
                      one_log,
                      own_log,
                      values.size()};
    model.scale.limit = settings.limit_rms.value_or(replicated.means(worst));
    model.limit_is = settings.limit_rms ? "given" : "the worst mean of a condition that was measured";
    model.healthy_is = "the mean of what was measured with all components as new";
    std::optional<double> healthy;
    for (Eigen::Index i = 0; i < distinct; ++i) {
      if (replicated.points.row(i).isZero()) healthy = replicated.means(i);
    }
    if (!healthy) {
      healthy = model.surface.At(Eigen::MatrixXd::Zero(1, replicated.points.cols())).mean(0);
      model.healthy_is = "the surface with all components as new, which was not measured";
    }
    model.scale.healthy = *healthy;
    if (!(model.scale.limit > model.scale.healthy)) {
      if (settings.limit_rms)
        Refuse("--limit-rms", fmt::format("{:g}", model.scale.limit),
               fmt::format("more than {:.6g}, as healthy", model.scale.healthy));
      notes.push_back(
          "system_rms is nowhere above that of new components: no index of the system can be told");
      return std::nullopt;
    }
    return model;
  } catch (const std::invalid_argument& error) {
    notes.push_back(fmt::format("no surface of the system: {}", error.what()));
  } catch (const std::domain_error& error) {
    notes.push_back(fmt::format("no surface of the system: {}", error.what()));
  }
  return std::nullopt;
}

SystemVariance VarianceOfSystem(const HealthData& data, std::vector<std::string>& notes) {
  SystemVariance variance;
  if (data.system.empty()) return variance;
  variance.recordings = TableOf(data.system, data.components, "the recordings", notes);
  const std::vector<SystemValue> means = UnitMeans(data.system);
  std::map<std::vector<double>, int> units;
  for (const SystemValue& value : means) ++units[{value.health.begin(), value.health.end()}];
  const bool several = std::ranges::any_of(units, [](const auto& entry) { return entry.second > 1; });
  if (several && means.size() < data.system.size())
    variance.units = TableOf(means, data.components, "the means of units", notes);
  return variance;
}

}  // namespace strainwave::bench
