// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/forest.h"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/ml.hpp>
#include <stdexcept>

namespace strainwave::analysis::prediction {
namespace {

// The features as OpenCV wants them: float, a row a sample.
using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

cv::Mat MatOf(RowMajor& values) {
  return {static_cast<int>(values.rows()), static_cast<int>(values.cols()), CV_32F, values.data()};
}

}  // namespace

// What a target is that never varies, OpenCV does not learn.
struct Forest::Trees {
  cv::Ptr<cv::ml::RTrees> model;  // none: `constant`
  float constant{};
};

Forest::Forest(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets, int trees) {
  constexpr Eigen::Index kFewestRows = 10;
  if (features.rows() != targets.rows() || features.rows() < kFewestRows || trees < 1) {
    throw std::invalid_argument(
        fmt::format("features has {} rows, targets {}, {} trees (expected the same, at least {}, and a tree)",
                    features.rows(), targets.rows(), trees, kFewestRows));
  }
  RowMajor inputs = features.cast<float>();
  for (Eigen::Index column = 0; column < targets.cols(); ++column) {
    RowMajor target = targets.col(column).cast<float>();
    auto forest = std::make_unique<Trees>();
    if (target.minCoeff() == target.maxCoeff()) {
      forest->constant = target(0);
      of_output_.push_back(std::move(forest));
      continue;
    }
    forest->model = cv::ml::RTrees::create();
    forest->model->setMaxDepth(16);
    forest->model->setMinSampleCount(4);
    forest->model->setRegressionAccuracy(0.0F);
    forest->model->setActiveVarCount(
        static_cast<int>(std::ceil(std::sqrt(static_cast<double>(features.cols())))));
    forest->model->setTermCriteria({cv::TermCriteria::COUNT, trees, 0.0});
    cv::theRNG().state = 1;
    forest->model->train(MatOf(inputs), cv::ml::ROW_SAMPLE, MatOf(target));
    of_output_.push_back(std::move(forest));
  }
}

Forest::Forest(Forest&&) noexcept = default;
Forest& Forest::operator=(Forest&&) noexcept = default;
Forest::~Forest() = default;

Eigen::MatrixXd Forest::Predict(const Eigen::MatrixXd& features) const {
  RowMajor inputs = features.cast<float>();
  Eigen::MatrixXd predicted(features.rows(), static_cast<Eigen::Index>(of_output_.size()));
  for (std::size_t column = 0; column < of_output_.size(); ++column) {
    if (of_output_[column]->model == nullptr) {
      predicted.col(static_cast<Eigen::Index>(column)).setConstant(of_output_[column]->constant);
      continue;
    }
    RowMajor values(features.rows(), 1);
    cv::Mat results = MatOf(values);
    of_output_[column]->model->predict(MatOf(inputs), results);
    predicted.col(static_cast<Eigen::Index>(column)) = values.col(0).cast<double>();
  }
  return predicted;
}

}  // namespace strainwave::analysis::prediction
