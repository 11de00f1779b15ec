// SPDX-License-Identifier: Apache-2.0
#include "bench/health/assess_health.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "bench/data_sets/labels.h"
#include "bench/errors/bench_error.h"
#include "bench/health/motor_records.h"
#include "bench/prediction/measurement_paths.h"

namespace strainwave::bench {
namespace {

namespace health = analysis::health;

// Columns of the model's inputs among all features of a record.
std::vector<Eigen::Index> ColumnsOf(const HealthModel& model,
                                    const analysis::features::PacketFeatures& features) {
  const std::vector<std::string> names = features.Names(kMotorChannels);
  std::vector<Eigen::Index> columns;
  for (const std::string& input : model.predictor.recipe.inputs) {
    const auto found = std::ranges::find(names, input);
    if (found == names.end())
      throw BenchError(ExitCode::kWrongInput,
                       fmt::format("error: the model's input '{}' is no feature of its recipe", input));
    columns.push_back(found - names.begin());
  }
  return columns;
}

double Quantile(std::vector<double>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

// A normal number from two even ones (Box and Muller), the same on every machine.
double Normal(std::mt19937_64& engine) {
  const auto even = [&engine] { return (static_cast<double>(engine() >> 11U) + 0.5) * 0x1p-53; };
  const double radius = std::sqrt(-2.0 * std::log(even()));
  return radius * std::cos(6.283185307179586 * even());
}

// Draws of the health within its interval, and of the surface there.
health::Bounded SystemOf(const SystemModel& system, const std::vector<health::Bounded>& of_components,
                         double quantile, health::IntervalOf interval) {
  // Each draw costs the square of the number of points that were measured.
  const Eigen::Index draws_in_all = system.surface.data().points.rows() > 100 ? 200 : 2000;
  const auto n = static_cast<Eigen::Index>(of_components.size());
  std::mt19937_64 engine(1);
  Eigen::MatrixXd points(draws_in_all + 1, n);
  for (Eigen::Index i = 0; i <= draws_in_all; ++i) {
    for (Eigen::Index c = 0; c < n; ++c) {
      const health::Bounded& one = of_components[static_cast<std::size_t>(c)];
      const double deviation = 0.5 * (one.high - one.low) / quantile;
      points(i, c) = std::clamp(one.value + (i == 0 ? 0.0 : deviation * Normal(engine)), 0.0, 1.0);
    }
  }
  const std::vector<health::SystemAt> at = [&] {
    // One point at a time: the joint covariance of so many is not needed.
    std::vector<health::SystemAt> all;
    const analysis::statistics::GaussianProcess& surface = system.surface;
    const double noise =
        interval == health::IntervalOf::kMeasurement ? surface.parameters().noise_variance : 0.0;
    for (Eigen::Index i = 0; i <= draws_in_all; ++i) {
      const analysis::statistics::Posterior one = surface.At(points.row(i));
      const double value = system.scale.Index(one.mean(0));
      const double deviation =
          std::abs(system.scale.factor()) * std::sqrt(std::max(0.0, one.covariance(0, 0)) + noise);
      all.push_back({{value, value - deviation, value + deviation}, false});
    }
    return all;
  }();
  std::vector<double> draws;
  for (std::size_t i = 1; i < at.size(); ++i)
    draws.push_back(at[i].index.value + (at[i].index.high - at[i].index.value) * Normal(engine));
  const double low = Quantile(draws, 0.025);
  const double high = Quantile(draws, 0.975);
  const double value = at.front().index.value;
  return {value, std::min(low, value), std::max(high, value)};
}

}  // namespace

bool NearFailedCondition(const HealthModel& model, const Eigen::VectorXd& state) {
  if (!model.system || model.failed.rows() == 0) return false;
  const Eigen::MatrixXd& measured = model.system->surface.data().points;
  const auto nearest = [&state](const Eigen::MatrixXd& points) {
    return (points.rowwise() - state.transpose()).rowwise().norm().minCoeff();
  };
  return nearest(model.failed) < nearest(measured);
}

HealthAssessment AssessHealth(const HealthModel& model, const RecordReader& reader,
                              const std::filesystem::path& file, health::IntervalOf interval) {
  const FeatureRecipe& recipe = model.predictor.recipe;
  analysis::features::PacketFeatures features(recipe.features.packets);
  const std::vector<Eigen::Index> columns = ColumnsOf(model, features);
  HealthAssessment result;
  result.file = file.string();
  std::vector<Eigen::MatrixXd> parts;
  for (MotorFeatures& record : FeaturesOfMotorFile(reader, file, features, recipe.sample_rate_hz)) {
    parts.push_back(record.values(Eigen::all, columns));
    result.cycles += record.values.rows();
    result.warnings.insert(result.warnings.end(), record.warnings.begin(), record.warnings.end());
  }
  Eigen::MatrixXd inputs(result.cycles, static_cast<Eigen::Index>(columns.size()));
  Eigen::Index at = 0;
  for (const Eigen::MatrixXd& part : parts) {
    inputs.middleRows(at, part.rows()) = part;
    at += part.rows();
  }
  const auto predicted = model.predictor.fitted.Predict(inputs);
  std::vector<double> distances(predicted.distance.begin(), predicted.distance.end());
  result.distance = Quantile(distances, 0.5);
  result.outside_training = !(result.distance <= 1.0);
  Eigen::VectorXd state(predicted.value.cols());
  for (Eigen::Index c = 0; c < predicted.value.cols(); ++c) {
    const double value = predicted.value.col(c).mean();
    // Cycles of one robot share their error: their number makes it no smaller.
    const double half = predicted.half_width.col(c).mean();
    result.health.push_back({value, value - half, value + half});
    state(c) = std::clamp(value, 0.0, 1.0);
  }
  if (model.system) {
    // Of the normal distribution at the coverage of the components' intervals.
    const double quantile = 1.6448536269514722;
    result.system = SystemOf(*model.system, result.health, quantile, interval);
    result.extrapolated =
        health::SystemsAt(model.system->surface, model.system->scale, state.transpose(), interval)
            .front()
            .extrapolated;
    result.near_failed_condition = NearFailedCondition(model, state);
  }
  return result;
}

std::vector<std::filesystem::path> HealthPaths(const std::vector<std::string>& paths) {
  std::vector<std::filesystem::path> files;
  for (const std::string& path : paths) {
    if (std::filesystem::exists(std::filesystem::path(path) / "labels.csv")) {
      const Labels labels = ReadLabels(path);
      for (const Labels::Row& row : labels.rows()) files.push_back(row.file);
      continue;
    }
    const MeasurementPaths sorted = SortPaths({path});
    files.insert(files.end(), sorted.files.begin(), sorted.files.end());
    if (!sorted.campaigns.empty()) Refuse(path, "is a campaign", "motor records");
  }
  return files;
}

}  // namespace strainwave::bench
