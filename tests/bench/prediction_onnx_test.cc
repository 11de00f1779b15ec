// SPDX-License-Identifier: Apache-2.0
// What is exported, read by others: OpenCV's dnn module and onnx's own checker.
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "bench/prediction/onnx_model.h"
#include "bench/prediction/onnx_network.h"
#include "tests/bench/random_predictor.h"

namespace strainwave::bench::prediction_onnx_test {
namespace {

namespace networks = analysis::networks;
namespace prediction = analysis::prediction;

prediction::FittedPredictor Dense(int members, bool beside_line = false) {
  return RandomPredictor(
      {{1, 12},
       {networks::Dense{9, networks::Activation::kSigmoid}, networks::Dense{7, networks::Activation::kTanh},
        networks::Dense{5, networks::Activation::kRelu}, networks::Dense{3, networks::Activation::kLinear}}},
      members, Head::kValues, beside_line);
}

prediction::FittedPredictor Classifier() {
  return RandomPredictor({{1, 12}, {networks::Dense{9, networks::Activation::kTanh}, networks::Dense{3}}}, 3,
                         Head::kClasses);
}

prediction::FittedPredictor Cnn() { return RandomPredictor(networks::DesignOf("cnn", 60, 4), 2); }

// Float against double: rounding of a few hundred operations.
constexpr double kAgreement = 1e-5;

void ExpectAgreement(const prediction::FittedPredictor& fitted) {
  const Eigen::Index inputs = fitted.ensemble.network.input_size();
  OnnxNetwork network(OnnxBytes(fitted, {}), inputs, fitted.ensemble.network.output_size());
  std::mt19937 engine(11);
  for (int k = 0; k < 20; ++k) {
    const Eigen::RowVectorXd features = Normal(1, inputs, engine);
    const auto trained = fitted.Predict(features);
    const auto exported = network.Run(features);
    for (Eigen::Index i = 0; i < exported.prediction.size(); ++i) {
      EXPECT_NEAR(exported.prediction(i), trained.value(0, i), kAgreement * std::abs(trained.value(0, i)));
      EXPECT_NEAR(exported.half_width(i), trained.half_width(0, i),
                  10.0 * kAgreement * trained.half_width(0, i));
    }
    EXPECT_NEAR(exported.distance, trained.distance(0), kAgreement * trained.distance(0));
  }
}

TEST(OnnxBytes, OpenCvAgreesWithADenseEnsemble) { ExpectAgreement(Dense(3)); }
TEST(OnnxBytes, OpenCvAgreesWithASingleNetwork) { ExpectAgreement(Dense(1)); }
TEST(OnnxBytes, OpenCvAgreesWithNetworksBesideALine) { ExpectAgreement(Dense(3, true)); }
TEST(OnnxBytes, OpenCvAgreesWithConvolutionalNetworks) { ExpectAgreement(Cnn()); }

TEST(OnnxBytes, OpenCvAgreesWithTheProbabilitiesOfAClassifier) {
  const auto fitted = Classifier();
  OnnxNetwork network(OnnxBytes(fitted, {}), 12, 3, OnnxNetwork::Predicts::kClasses);
  std::mt19937 engine(11);
  for (int k = 0; k < 20; ++k) {
    const Eigen::RowVectorXd features = Normal(1, 12, engine);
    const auto trained = fitted.Predict(features);
    const auto exported = network.Run(features);
    EXPECT_NEAR(exported.prediction.sum(), 1.0, kAgreement);
    EXPECT_LT((exported.prediction - trained.value.row(0)).cwiseAbs().maxCoeff(), kAgreement);
    EXPECT_NEAR(exported.distance, trained.distance(0), kAgreement * trained.distance(0));
  }
}

TEST(OnnxBytes, PassTheirOwnersChecker) {
  if (std::system("/usr/bin/python3 -c 'import onnx' 2>/dev/null") != 0) {
    GTEST_SKIP() << "skipped, because /usr/bin/python3 has no onnx";
  }
  const auto file =
      std::filesystem::temp_directory_path() / ("strainwave_" + std::to_string(::getpid()) + ".onnx");
  for (const auto& fitted : {Dense(2), Dense(2, true), Cnn()}) {
    std::ofstream(file, std::ios::binary) << OnnxBytes(fitted, {{"output_0", "k2_Nm_per_rad"}});
    const std::string command =
        "/usr/bin/python3 -c \"import onnx; m = onnx.load('" + file.string() +
        "'); onnx.checker.check_model(m, full_check=True); "
        "assert [o.name for o in m.graph.output] == ['prediction', 'half_width', 'distance']; "
        "assert m.metadata_props[0].value == 'k2_Nm_per_rad'\"";
    EXPECT_EQ(std::system(command.c_str()), 0);
  }
  std::ofstream(file, std::ios::binary) << OnnxBytes(Classifier(), {{"output_0", "cracked"}});
  const std::string command = "/usr/bin/python3 -c \"import onnx; m = onnx.load('" + file.string() +
                              "'); onnx.checker.check_model(m, full_check=True); "
                              "assert [o.name for o in m.graph.output] == ['probability', 'distance']\"";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::filesystem::remove(file);
}

TEST(OnnxBytes, RefuseAnEnsembleWithoutANetwork) {
  EXPECT_THROW(OnnxBytes(Dense(0), {}), std::invalid_argument);
}

std::string RefusalOf(const std::string& bytes, Eigen::Index inputs = 12, Eigen::Index outputs = 3) {
  try {
    OnnxNetwork(bytes, inputs, outputs);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(OnnxNetwork, RefusesAFileOfAnotherShape) {
  const std::string bytes = OnnxBytes(Dense(2), {});
  EXPECT_EQ(RefusalOf(bytes), "accepted");
  EXPECT_EQ(RefusalOf(bytes, 13),
            "the ONNX file has 'features' where 'features' of records × 13 should be (expected one that "
            "`strainwave "
            "export` wrote)");
  EXPECT_EQ(RefusalOf(bytes, 12, 4),
            "the ONNX file has 'prediction' where 'prediction' of records × 4 should be (expected one that "
            "`strainwave "
            "export` wrote)");
  EXPECT_EQ(RefusalOf("not onnx"),
            "the ONNX file cannot be parsed (expected one that `strainwave export` wrote)");
  EXPECT_EQ(RefusalOf(""),
            "the ONNX file has 0 inputs and 0 outputs (expected one that `strainwave export` wrote)");
}

// Whatever bytes there are, it is refused in words or it runs; it never ends the program.
TEST(OnnxNetwork, OutlivesDamage) {
  const std::string whole = OnnxBytes(Dense(2), {});
  std::mt19937 engine(3);
  int refused = 0;
  for (int k = 0; k < 3000; ++k) {
    std::string damaged = whole;
    const int changes = 1 + static_cast<int>(engine() % 4);
    for (int i = 0; i < changes; ++i) damaged[engine() % damaged.size()] = static_cast<char>(engine());
    if (k % 5 == 0) damaged.resize(engine() % damaged.size());
    refused += RefusalOf(damaged) != "accepted";
  }
  EXPECT_GT(refused, 600);  // the cut ones at least; a changed weight is another network
}

}  // namespace
}  // namespace strainwave::bench::prediction_onnx_test
