// SPDX-License-Identifier: Apache-2.0
#include "bench/health/health_json.h"

#include <cmath>
#include <map>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "bench/health/motor_records.h"

namespace strainwave::bench {
namespace {

namespace statistics = analysis::statistics;
using Json = nlohmann::ordered_json;

Json NumberOf(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json ListOf(const Eigen::VectorXd& values) { return std::vector<double>(values.begin(), values.end()); }

Json RowsOf(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) rows.push_back(ListOf(matrix.row(i)));
  return rows;
}

Json ByComponent(const HealthData& data, const Eigen::RowVectorXd& values) {
  Json json;
  for (std::size_t c = 0; c < data.components.size(); ++c)
    json[data.components[c]] = values(static_cast<Eigen::Index>(c));
  return json;
}

Json TableOf(const std::optional<statistics::VarianceTable>& table) {
  Json rows = Json::array();
  if (!table) return rows;
  for (const statistics::VarianceSource& row : table->rows) {
    rows.push_back({{"source", row.source},
                    {"ss", row.sum_of_squares},
                    {"df", row.degrees_of_freedom},
                    {"f", NumberOf(row.f)},
                    {"p", NumberOf(row.p)},
                    {"eta_squared", NumberOf(row.eta_squared)},
                    {"partial_eta_squared", NumberOf(row.partial_eta_squared)},
                    {"partial_low", NumberOf(row.partial_low)},
                    {"partial_high", NumberOf(row.partial_high)}});
  }
  return rows;
}

Json SelectedOf(const HealthData& data, const ChosenFeatures& chosen,
                std::vector<Eigen::Index> analysis::health::Selection::*which) {
  Json json;
  for (std::size_t c = 0; c < data.components.size(); ++c) {
    Json names = Json::array();
    for (const Eigen::Index feature : chosen.of_component[c].*which)
      names.push_back(data.samples.inputs[static_cast<std::size_t>(feature)]);
    json[data.components[c]] = std::move(names);
  }
  return json;
}

Json ScoresOf(const HealthData& data, const ChosenFeatures& chosen) {
  Json json;
  for (std::size_t c = 0; c < data.components.size(); ++c) {
    const analysis::health::ComponentScores& scores = chosen.scores[c];
    const analysis::health::Selection& selection = chosen.of_component[c];
    Json features = Json::array();
    for (const Eigen::Index feature : selection.kept) {
      features.push_back({{"feature", data.samples.inputs[static_cast<std::size_t>(feature)]},
                          {"score", scores.score(feature)},
                          {"correlation", scores.correlation(feature)},
                          {"correlation_of_magnitudes", scores.magnitudes(feature)},
                          {"fisher_ratio", scores.fisher(feature)}});
    }
    // Where trends of two cells run against each other.
    Json opposed = Json::array();
    constexpr double kOpposed = 0.5;
    for (Eigen::Index f = 0; f < scores.score.size(); ++f) {
      if (scores.magnitudes(f) - scores.correlation(f) > kOpposed)
        opposed.push_back(data.samples.inputs[static_cast<std::size_t>(f)]);
    }
    json[data.components[c]] = {{"threshold", selection.threshold.threshold},
                                {"threshold_rise_percent", selection.threshold.rise_percent},
                                {"above_threshold", selection.above.size()},
                                {"cells", scores.cells},
                                {"kept", std::move(features)},
                                {"opposed_trends", std::move(opposed)}};
  }
  return json;
}

Json BandsOf(const HealthData& data) {
  Json bands = Json::array();
  for (const auto& band : analysis::features::PacketBands(data.recipe.levels, data.sample_rate_hz)) {
    bands.push_back({{"path", band.path},
                     {"by_frequency", "W" + std::to_string(band.by_frequency)},
                     {"low_hz", band.low_hz},
                     {"high_hz", band.high_hz}});
  }
  return bands;
}

Json SplitsOf(const HealthData& data, const HealthOutcome& outcome) {
  Json splits = Json::array();
  for (const HealthSplit& split : outcome.splits) {
    splits.push_back({{"split", split.name},
                      {"meaning", split.meaning},
                      {"train", split.trained},
                      {"test", split.tested},
                      {"rmse", ByComponent(data, split.rmse)},
                      {"ridge_rmse", ByComponent(data, split.ridge_rmse)},
                      {"mean_rmse", ByComponent(data, split.mean_rmse)}});
  }
  return splits;
}

Json RmseOf(const HealthData& data, const HealthOutcome& outcome) {
  Json json;
  for (std::size_t c = 0; c < data.components.size(); ++c) {
    Json of_component;
    for (const char* name : {"condition_left_out", "unit_left_out", "random"}) {
      of_component[name] = nullptr;
      for (const HealthSplit& split : outcome.splits) {
        if (split.name == name) of_component[name] = split.rmse(static_cast<Eigen::Index>(c));
      }
    }
    json[data.components[c]] = std::move(of_component);
  }
  return json;
}

Json SurfaceOf(const SystemModel& system) {
  const statistics::GaussianProcessParameters& parameters = system.surface.parameters();
  return {{"length", ListOf(parameters.length)},
          {"signal_variance", parameters.signal_variance},
          {"noise_variance", parameters.noise_variance},
          {"log_likelihood", system.surface.log_likelihood()},
          {"mean", system.surface.mean()},
          {"measurements", system.measurements},
          {"kernel", system.one_length ? "squared exponential, one length"
                                       : "squared exponential, a length a component"},
          {"one_length_log_likelihood", system.one_length_log_likelihood},
          {"own_lengths_log_likelihood", system.own_lengths_log_likelihood},
          {"units",
           {{"length", "of health, 0 to 1: over which the system's performance changes"},
            {"signal_variance", "square of the unit of system_rms: of the surface about its mean"},
            {"noise_variance", "square of the unit of system_rms: of one measurement about the surface"}}}};
}

}  // namespace

Json JsonOf(const SystemModel& system, const std::vector<std::string>& components) {
  const statistics::ReplicatedData& data = system.surface.data();
  Json json = SurfaceOf(system);
  json["components"] = components;
  json["places"] = RowsOf(data.points);
  json["means"] = ListOf(data.means);
  json["counts"] = ListOf(data.counts);
  json["within"] = data.within;
  json["healthy"] = system.scale.healthy;
  json["healthy_is"] = system.healthy_is;
  json["limit"] = system.scale.limit;
  json["limit_is"] = system.limit_is;
  json["one_length"] = system.one_length;
  return json;
}

SystemModel SystemFrom(const Json& json, std::size_t components) {
  const auto vector = [](const Json& list) {
    const auto values = list.get<std::vector<double>>();
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  statistics::ReplicatedData data;
  data.means = vector(json.at("means"));
  data.counts = vector(json.at("counts"));
  data.within = json.at("within").get<double>();
  const Json& points = json.at("places");
  if (points.size() != static_cast<std::size_t>(data.means.size()) ||
      data.means.size() != data.counts.size() || points.empty())
    throw std::invalid_argument("places, means and counts of the surface are not of one length");
  data.points.resize(static_cast<Eigen::Index>(points.size()), static_cast<Eigen::Index>(components));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::VectorXd point = vector(points[i]);
    if (point.size() != data.points.cols())
      throw std::invalid_argument("a place of the surface has other components");
    data.points.row(static_cast<Eigen::Index>(i)) = point;
  }
  const statistics::GaussianProcessParameters parameters{json.at("signal_variance").get<double>(),
                                                         vector(json.at("length")),
                                                         json.at("noise_variance").get<double>()};
  return {statistics::GaussianProcess(data, parameters, statistics::MeanOf::kConstant),
          {json.at("healthy").get<double>(), json.at("limit").get<double>()},
          json.at("limit_is").get<std::string>(),
          json.at("healthy_is").get<std::string>(),
          json.at("one_length").get<bool>(),
          json.at("one_length_log_likelihood").get<double>(),
          json.at("own_lengths_log_likelihood").get<double>(),
          json.at("measurements").get<std::size_t>()};
}

Json TrainingJsonOf(const HealthData& data, const HealthJob& job, const HealthOutcome& outcome) {
  std::map<int, std::size_t> cycles;
  for (const int unit : data.samples.specimen) ++cycles[unit];
  Json campaigns = Json::array();
  for (std::size_t u = 0; u < data.units.size(); ++u)
    campaigns.push_back({{"folder", data.folder.filename().string()},
                         {"specimen", data.units[u]},
                         {"records", cycles[static_cast<int>(u)]}});
  return {{"what", "health of components"},
          {"data_sha256", data.sha256},
          {"campaigns", std::move(campaigns)},
          {"design", "one hidden layer, tanh, " + std::to_string(outcome.hidden_nodes) + " nodes"},
          {"seed", job.seed},
          {"records", data.samples.size()},
          {"splits", SplitsOf(data, outcome)}};
}

Json ReportOf(const HealthData& data, const HealthJob& job, const HealthOutcome& outcome) {
  Json trials = Json::array();
  for (const HiddenTrial& trial : outcome.trials)
    trials.push_back({{"nodes", trial.nodes}, {"rmse", trial.rmse}});
  Json report{{"components", data.components},
              {"selected", SelectedOf(data, outcome.chosen, &analysis::health::Selection::kept)},
              {"hidden_nodes", outcome.hidden_nodes},
              {"rmse", RmseOf(data, outcome)},
              {"anova", TableOf(outcome.variance.recordings)},
              {"gpr", outcome.system ? SurfaceOf(*outcome.system) : Json(nullptr)}};
  if (outcome.variance.recordings) {
    report["anova_type"] = statistics::NameOf(outcome.variance.recordings->type);
    report["anova_notes"] = outcome.variance.recordings->notes;
  }
  if (outcome.variance.units) report["anova_of_unit_means"] = TableOf(outcome.variance.units);
  if (outcome.system) {
    report["system"] = {{"healthy", outcome.system->scale.healthy},
                        {"healthy_is", outcome.system->healthy_is},
                        {"limit", outcome.system->scale.limit},
                        {"limit_is", outcome.system->limit_is}};
  }
  report["splits"] = SplitsOf(data, outcome);
  report["selection"] = ScoresOf(data, outcome.chosen);
  report["bands"] = BandsOf(data);
  report["hidden_node_search"] = std::move(trials);
  report["coverage"] = job.coverage;
  report["records"] = data.files.size();
  report["cycles"] = data.samples.size();
  report["cycle_rows"] = {data.shortest, data.longest};
  report["cut"] = data.cut;
  report["sample_rate_hz"] = data.sample_rate_hz;
  report["units"] = data.units.size();
  report["conditions"] = RowsOf(data.conditions);
  report["failed_conditions"] = RowsOf(data.failed);
  report["data_sha256"] = data.sha256;
  report["seed"] = job.seed;
  report["notes"] = outcome.notes;
  report["warnings"] = WarningTexts(data.warnings, NamedFiles::kYes);
  return report;
}

}  // namespace strainwave::bench
