// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/prediction/export_predictor.h"
#include "bench/prediction/signal_inputs.h"
#include "bench/sha256.h"

namespace strainwave::bench {

/// A folder of its own, gone when the test is over.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "strainwave-monitor-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  ~TestFolder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string ReadText(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// Changes a sealed file as someone who knows how it is made, and hashes it again.
inline void RewriteSealed(const std::filesystem::path& path,
                          const std::function<void(nlohmann::ordered_json&)>& change) {
  auto json = nlohmann::ordered_json::parse(ReadText(path));
  json.erase("sha256");
  change(json);
  json["sha256"] = Sha256(json.dump());
  std::ofstream(path, std::ios::binary) << json.dump();
}

/// What an action is refused with as wrong input, without the name of its folder.
inline std::string RefusalWithin(const std::filesystem::path& folder, const std::function<void()>& action) {
  try {
    action();
  } catch (const BenchError& error) {
    EXPECT_EQ(error.exit_code(), ExitCode::kWrongInput);
    std::string text = error.what();
    const std::string prefix = folder.string() + "/";
    return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
  }
  return "accepted";
}

/// Channels of a machine that does not exist: a line each, of other size and frequency, and noise.
inline std::vector<std::vector<double>> TestSignals(std::size_t channels, std::size_t samples,
                                                    unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.1);
  std::vector<std::vector<double>> signals(channels, std::vector<double>(samples));
  for (std::size_t k = 0; k < channels; ++k) {
    const double size = 1.0 + static_cast<double>(k);
    for (std::size_t i = 0; i < samples; ++i) {
      signals[k][i] = size * std::sin(0.05 * size * static_cast<double>(i)) + noise(random);
    }
  }
  return signals;
}

inline std::vector<NamedSignal> Named(const std::vector<std::string>& channels,
                                      const std::vector<std::vector<double>>& signals) {
  std::vector<NamedSignal> named;
  for (std::size_t k = 0; k < channels.size(); ++k) named.push_back({channels[k], signals[k]});
  return named;
}

/// Root-mean-square and standard deviation of each level, two outputs, random weights; `TestSignals` lie
/// within what it "was trained on", other sizes of a channel do not.
inline Predictor TestPredictor(const FeatureRecipe& recipe, const analysis::networks::Design& design,
                               int members) {
  Predictor predictor{
      .recipe = recipe,
      .outputs = {"k2_Nm_per_rad", "e_max_arcmin"},
      .fitted = {.ensemble = {.input = {},
                              .output = {},
                              .network = analysis::networks::Network(design),
                              .members = {}},
                 .residual = Eigen::RowVectorXd::Constant(2, 0.5),
                 .band = {.coverage = 0.9,
                          .factor = Eigen::RowVectorXd::Constant(2, 1.5),
                          .guaranteed = true},
                 .novelty = {},
                 .least = {},
                 .greatest = {}},
      .training_json = R"({"data_sha256": "0", "design": "test", "campaigns": [], "splits": []})"};
  const auto count = static_cast<Eigen::Index>(recipe.inputs.size());
  SignalInputs inputs(recipe);
  Eigen::RowVectorXd middle;
  inputs.Compute(Named(recipe.channels, TestSignals(recipe.channels.size(), recipe.least_samples)),
                 recipe.sample_rate_hz, std::nullopt, middle);
  auto& fitted = predictor.fitted;
  fitted.ensemble.input = {middle, 0.5 * middle.cwiseAbs().cwiseMax(1.0)};
  fitted.ensemble.output = {Eigen::RowVectorXd::Constant(2, 50.0), Eigen::RowVectorXd::Ones(2)};
  for (int k = 0; k < members; ++k) {
    fitted.ensemble.members.push_back(analysis::networks::InitialParameters<double>(
        fitted.ensemble.network, static_cast<std::uint64_t>(k)));
  }
  fitted.novelty = {.mean = Eigen::RowVectorXd::Zero(count),
                    .whitening = Eigen::MatrixXd::Identity(count, count),
                    .limit = 0.5};
  fitted.least = middle.array() - 0.1;
  fitted.greatest = middle.array() + 0.1;
  return predictor;
}

inline FeatureRecipe TestRecipe() {
  FeatureRecipe recipe{.features = {.wavelet = {.wavelet = "db2", .levels = 2}, .orders = {}},
                       .channels = {"accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2"},
                       .sample_rate_hz = 1000.0,
                       .window = {},
                       .least_samples = 1000,
                       .inputs = {}};
  for (const std::string& channel : recipe.channels) {
    for (const char* level : {".a1.", ".a2."}) {
      recipe.inputs.push_back(channel + level + "root_mean_square");
      recipe.inputs.push_back(channel + level + "standard_deviation");
    }
  }
  return recipe;
}

/// Writes a small exported predictor there.
inline void WriteTestExport(const std::filesystem::path& folder, const FeatureRecipe& recipe = TestRecipe()) {
  using analysis::networks::Activation;
  using analysis::networks::Dense;
  ExportPredictor(
      TestPredictor(recipe, {{1, 12}, {Dense{6, Activation::kTanh}, Dense{2, Activation::kLinear}}}, 3),
      folder);
}

}  // namespace strainwave::bench
