// SPDX-License-Identifier: Apache-2.0
#include "analysis/explanation/expected_gradients.h"

#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <variant>
#include <vector>

#include "analysis/networks/activation.h"
#include "analysis/shuffle.h"

namespace strainwave::analysis::explanation {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The values of all layers for one input, and the slopes of the outputs by it.
class Slopes {
 public:
  Slopes(const networks::Network& network, const networks::Vector<double>& parameters)
      : network_(network), parameters_(parameters) {}

  Eigen::VectorXd Outputs(const Eigen::VectorXd& input) {
    values_.clear();
    Eigen::VectorXd at = input;
    for (const networks::Network::Stage& stage : network_.stages()) {
      Eigen::VectorXd next =
          Weights(stage) * at + parameters_.segment(stage.weights_begin + stage.weights, stage.biases);
      networks::Activate(std::get<networks::Dense>(stage.layer).activation, next);
      values_.push_back(next);
      at = next;
    }
    return at;
  }

  // inputs × outputs, after `Outputs`.
  Eigen::MatrixXd ByInput() const {
    const Eigen::Index outputs = network_.output_size();
    Eigen::MatrixXd gradient = Eigen::MatrixXd::Identity(outputs, outputs);
    for (std::size_t s = network_.stages().size(); s-- > 0;) {
      const networks::Network::Stage& stage = network_.stages()[s];
      for (Eigen::Index o = 0; o < outputs; ++o) {
        auto column = gradient.col(o);
        networks::MultiplyBySlope(std::get<networks::Dense>(stage.layer).activation, values_[s], column);
      }
      gradient = Weights(stage).transpose() * gradient;
    }
    return gradient;
  }

 private:
  Eigen::Map<const RowMajor> Weights(const networks::Network::Stage& stage) const {
    return {parameters_.data() + stage.weights_begin, stage.output.size(), stage.input.size()};
  }

  const networks::Network& network_;
  const networks::Vector<double>& parameters_;
  std::vector<Eigen::VectorXd> values_;
};

}  // namespace

ExpectedGradients ExpectedGradientsOf(const networks::Network& network,
                                      const networks::Vector<double>& parameters,
                                      const Eigen::VectorXd& sample, const Eigen::MatrixXd& background,
                                      int draws, std::uint64_t seed) {
  for (const networks::Network::Stage& stage : network.stages()) {
    if (!std::holds_alternative<networks::Dense>(stage.layer))
      throw std::invalid_argument("a network with a layer that is not dense");
  }
  if (sample.size() != network.input_size() || background.rows() != sample.size() || background.cols() == 0 ||
      draws < 2)
    throw std::invalid_argument(
        "sample, background and network differ in their inputs, or fewer than 2 draws");
  std::mt19937_64 random(seed);
  std::vector<int> strata(static_cast<std::size_t>(draws));
  std::iota(strata.begin(), strata.end(), 0);
  Shuffle(strata, random);
  Slopes slopes(network, parameters);
  const Eigen::Index outputs = network.output_size();
  ExpectedGradients result{Eigen::MatrixXd::Zero(sample.size(), outputs),
                           Eigen::MatrixXd::Zero(sample.size(), outputs), Eigen::VectorXd::Zero(outputs)};
  for (int k = 0; k < draws; ++k) {
    const Eigen::VectorXd from = background.col(k % background.cols());
    const double alpha = (strata[static_cast<std::size_t>(k)] + 0.5) / draws;
    slopes.Outputs(from + alpha * (sample - from));
    const Eigen::MatrixXd share = slopes.ByInput().array().colwise() * (sample - from).array();
    result.shares += share;
    result.standard_errors.array() += share.array().square();
  }
  const double count = draws;
  result.shares /= count;
  result.standard_errors =
      ((result.standard_errors.array() / count - result.shares.array().square()).max(0.0) / (count - 1.0))
          .sqrt();
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(outputs);
  for (Eigen::Index row = 0; row < background.cols(); ++row) mean += slopes.Outputs(background.col(row));
  mean /= static_cast<double>(background.cols());
  result.gap = slopes.Outputs(sample) - mean - result.shares.colwise().sum().transpose();
  return result;
}

}  // namespace strainwave::analysis::explanation
