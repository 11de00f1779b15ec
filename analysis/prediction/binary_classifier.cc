// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/binary_classifier.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/ml.hpp>

#include "analysis/prediction/forest.h"
#include "analysis/prediction/scaler.h"

namespace strainwave::analysis::prediction {
namespace {

using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

cv::Mat ViewOf(FloatRows& values) {
  return {static_cast<int>(values.rows()), static_cast<int>(values.cols()), CV_32F, values.data()};
}

void RequireBothClasses(const Eigen::MatrixXd& features, std::span<const int> actual) {
  constexpr std::size_t kFewest = 10;
  const auto ones = std::ranges::count(actual, 1);
  if (static_cast<std::size_t>(features.rows()) != actual.size() || actual.size() < kFewest || ones == 0 ||
      ones == static_cast<std::ptrdiff_t>(actual.size()))
    throw std::invalid_argument(
        fmt::format("{} rows with {} classes, {} of them 1 (expected as many, {} or more, and both classes)",
                    features.rows(), actual.size(), ones, kFewest));
}

Eigen::VectorXd ForestScores(const Eigen::MatrixXd& features, std::span<const int> actual,
                             const Eigen::MatrixXd& tested) {
  constexpr int kTrees = 100;
  Eigen::MatrixXd targets(features.rows(), 1);
  for (Eigen::Index row = 0; row < targets.rows(); ++row)
    targets(row, 0) = actual[static_cast<std::size_t>(row)];
  return Forest(features, targets, kTrees).Predict(tested).col(0);
}

Eigen::VectorXd SvmScores(const Eigen::MatrixXd& features, std::span<const int> actual,
                          const Eigen::MatrixXd& tested) {
  FloatRows inputs = features.cast<float>();
  cv::Mat labels(static_cast<int>(actual.size()), 1, CV_32S);
  for (std::size_t i = 0; i < actual.size(); ++i) labels.at<int>(static_cast<int>(i)) = actual[i];
  const auto machine = cv::ml::SVM::create();
  machine->setType(cv::ml::SVM::C_SVC);
  machine->setKernel(cv::ml::SVM::RBF);
  machine->setC(1.0);
  machine->setGamma(1.0 / static_cast<double>(features.cols()));
  constexpr int kMostSteps = 20000;
  machine->setTermCriteria({cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kMostSteps, 1e-4});
  machine->train(ViewOf(inputs), cv::ml::ROW_SAMPLE, labels);
  FloatRows others = tested.cast<float>();
  FloatRows distances(others.rows(), 1);
  cv::Mat results = ViewOf(distances);
  machine->predict(ViewOf(others), results, cv::ml::StatModel::RAW_OUTPUT);
  // OpenCV's distance is positive on the side of the class that comes first, which is 0.
  return -distances.col(0).cast<double>();
}

Eigen::VectorXd LogisticScores(const Eigen::MatrixXd& features, std::span<const int> actual,
                               const Eigen::MatrixXd& tested) {
  FloatRows inputs = features.cast<float>();
  FloatRows targets(features.rows(), 1);
  for (Eigen::Index row = 0; row < targets.rows(); ++row)
    targets(row, 0) = static_cast<float>(actual[static_cast<std::size_t>(row)]);
  const auto regression = cv::ml::LogisticRegression::create();
  regression->setLearningRate(0.5);
  regression->setIterations(400);
  regression->setRegularization(cv::ml::LogisticRegression::REG_L2);
  regression->setTrainMethod(cv::ml::LogisticRegression::BATCH);
  regression->train(ViewOf(inputs), cv::ml::ROW_SAMPLE, ViewOf(targets));
  // It predicts classes alone; the probability comes from its weights, the constant first.
  const cv::Mat weights = regression->get_learnt_thetas();
  Eigen::VectorXd scores = Eigen::VectorXd::Constant(tested.rows(), weights.at<float>(0));
  for (Eigen::Index i = 0; i < tested.cols(); ++i)
    scores += static_cast<double>(weights.at<float>(static_cast<int>(i) + 1)) * tested.col(i);
  return 1.0 / (1.0 + (-scores.array()).exp());
}

}  // namespace

std::string_view NameOf(BinaryKind kind) {
  switch (kind) {
    case BinaryKind::kNetwork:
      return "network";
    case BinaryKind::kForest:
      return "forest";
    case BinaryKind::kSvm:
      return "svm";
    case BinaryKind::kLogisticRegression:
      return "logistic_regression";
  }
  return "";
}

double ThresholdOf(BinaryKind kind) { return kind == BinaryKind::kSvm ? 0.0 : 0.5; }

Ensemble TrainBinaryNetwork(const Eigen::MatrixXd& features, std::span<const int> actual,
                            const BinarySettings& settings) {
  RequireBothClasses(features, actual);
  Samples samples;
  samples.features = features;
  samples.targets = Eigen::MatrixXd::Zero(features.rows(), 2);
  samples.specimen.assign(actual.size(), 0);
  samples.outputs = {"0", "1"};
  samples.classes = true;
  for (std::size_t i = 0; i < actual.size(); ++i) {
    samples.targets(static_cast<Eigen::Index>(i), actual[i]) = 1.0;
    samples.cycle.push_back(static_cast<double>(i));
  }
  for (Eigen::Index i = 0; i < features.cols(); ++i) samples.inputs.push_back(fmt::format("x{}", i + 1));
  EnsembleSettings ensemble;
  ensemble.design.input = {1, static_cast<int>(features.cols())};
  using networks::Activation, networks::Dense;
  ensemble.design.layers = {Dense{64, Activation::kRelu}, Dense{32, Activation::kRelu},
                            Dense{2, Activation::kLinear}};
  ensemble.training.loss = networks::Loss::kCrossEntropy;
  ensemble.training.optimizer = networks::Adam{};
  ensemble.training.epochs = settings.epochs;
  ensemble.training.batch = settings.batch;
  ensemble.training.weight_decay = 1e-3;
  ensemble.training.seed = settings.seed;
  return TrainEnsemble(samples, ensemble);
}

Eigen::VectorXd TrainAndScore(BinaryKind kind, const Eigen::MatrixXd& features, std::span<const int> actual,
                              const Eigen::MatrixXd& tested, const BinarySettings& settings) {
  RequireBothClasses(features, actual);
  if (kind == BinaryKind::kNetwork)
    return TrainBinaryNetwork(features, actual, settings).Predict(tested).mean.col(1);
  const Scaler scaler = Standardizing(features);
  const Eigen::MatrixXd inputs = scaler.Apply(features);
  const Eigen::MatrixXd others = scaler.Apply(tested);
  switch (kind) {
    case BinaryKind::kForest:
      return ForestScores(inputs, actual, others);
    case BinaryKind::kSvm:
      return SvmScores(inputs, actual, others);
    case BinaryKind::kNetwork:
    case BinaryKind::kLogisticRegression:
      break;
  }
  return LogisticScores(inputs, actual, others);
}

}  // namespace strainwave::analysis::prediction
