// SPDX-License-Identifier: Apache-2.0
#include "bench/health/health_file.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "bench/errors/bench_error.h"
#include "bench/health/health_json.h"
#include "bench/json_text.h"
#include "bench/prediction/sealed_json.h"
#include "bench/sha256.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr const char* kFile = "health.json";
constexpr const char* kExpected = "a model, as `strainwave health train` writes it";

}  // namespace

void WriteHealthModel(const std::filesystem::path& folder, const HealthData& data, const HealthJob& job,
                      const HealthOutcome& outcome) {
  std::filesystem::create_directories(folder);
  WritePredictor(folder, *outcome.predictor);
  Json failed = Json::array();
  for (Eigen::Index i = 0; i < data.failed.rows(); ++i) {
    const Eigen::VectorXd row = data.failed.row(i);
    failed.push_back(std::vector<double>(row.begin(), row.end()));
  }
  Json json{{"health", kFormat},
            {"components", data.components},
            {"system", outcome.system ? JsonOf(*outcome.system, data.components) : Json(nullptr)},
            {"failed_conditions", std::move(failed)},
            {"report", ReportOf(data, job, outcome)},
            {"predictor_sha256", Sha256OfFile(folder / "predictor.json")}};
  Seal(json);
  daq::WriteFileAtomically(folder / kFile, json.dump(2) + "\n");
}

HealthModel ReadHealthModel(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kFile;
  const std::string text = ReadBounded(file, kExpected);
  try {
    const Json json = ParseJson(text);
    if (json.at("health").get<int>() != kFormat)
      Refuse(file, fmt::format("format {}", ShortText(json.at("health"))), fmt::format("format {}", kFormat));
    RequireSeal(file, json);
    if (Sha256(ReadBounded(folder / "predictor.json", kExpected)) !=
        json.at("predictor_sha256").get<std::string>())
      Refuse(folder / "predictor.json", "the file is of another training",
             "the SHA-256 that health.json has of it");
    auto components = json.at("components").get<std::vector<std::string>>();
    Predictor predictor = ReadPredictor(folder);
    if (predictor.outputs != components)
      throw std::invalid_argument("predictor and surface have other components");
    std::optional<SystemModel> system;
    if (!json.at("system").is_null()) system = SystemFrom(json.at("system"), components.size());
    Eigen::MatrixXd failed(static_cast<Eigen::Index>(json.at("failed_conditions").size()),
                           static_cast<Eigen::Index>(components.size()));
    for (Eigen::Index i = 0; i < failed.rows(); ++i) {
      for (Eigen::Index c = 0; c < failed.cols(); ++c)
        failed(i, c) = json.at("failed_conditions")
                           .at(static_cast<std::size_t>(i))
                           .at(static_cast<std::size_t>(c))
                           .get<double>();
    }
    return {std::move(predictor), std::move(components), std::move(system), std::move(failed),
            json.at("report")};
  } catch (const Json::exception& error) {
    Refuse(file, fmt::format("cannot be used: {}", error.what()), "the file as it was written");
  } catch (const std::invalid_argument& error) {
    Refuse(file, fmt::format("cannot be used: {}", error.what()), "the file as it was written");
  } catch (const std::domain_error& error) {
    Refuse(file, fmt::format("cannot be used: {}", error.what()), "the file as it was written");
  }
}

}  // namespace strainwave::bench
