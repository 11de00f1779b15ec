// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <vector>

#include "analysis/networks/network.h"
#include "analysis/networks/training.h"
#include "analysis/prediction/samples.h"
#include "analysis/prediction/scaler.h"

namespace strainwave::analysis::prediction {

/// How a network is trained on samples.
struct EnsembleSettings {
  networks::Design design;
  networks::TrainingOptions training;
  int members{1};                // networks that differ in their seed alone
  double validation_share{0.0};  // of the records, in blocks of time, apart for early stopping; 0: none
  bool beside_line{false};       // a ridge first: the networks learn what it leaves
  ParallelFor parallel{InTurn};  // over the members
};

/// The caller wanted no more of it.
class TrainingEnded : public std::runtime_error {
 public:
  TrainingEnded() : std::runtime_error("the training was ended before all networks were trained") {}
};

/// What networks are trained beside: a line goes on where they end. Where an input leaves the range of the
/// training by a quarter of it, the line stands still: what noise throws far out says no more than that.
struct Line {
  Eigen::MatrixXd slope;  // inputs × outputs, of scaled inputs, in the outputs' units; empty: there is none
  Eigen::RowVectorXd lowest;  // of each scaled input
  Eigen::RowVectorXd highest;

  bool empty() const noexcept { return slope.size() == 0; }
  /// @param scaled  n × inputs.  @return n × outputs, without a level.
  Eigen::MatrixXd Along(const Eigen::MatrixXd& scaled) const;
};

/// Networks of one design that were trained alike, with the scalers around them.
struct Ensemble {
  Scaler input;
  Scaler output;
  Line line{};  // its level is in the output's offset
  networks::Network network;
  std::vector<networks::Vector<double>> members;
  bool softmax{};  // outputs are probabilities of classes: exp z over the sum of all exp z

  /// What the members say of records: their mean, and how far apart they are.
  struct Prediction {
    Eigen::MatrixXd mean;    // n × outputs
    Eigen::MatrixXd spread;  // n × outputs: standard deviation over the members; 0 for a single one
  };
  /// @param features  n × inputs, unscaled.
  Prediction Predict(const Eigen::MatrixXd& features) const;
};

/// Told after each epoch, on whatever thread trains the member; false ends the training of all.
using TrainingProgress = std::function<bool(int member, int epoch, double loss)>;

/// Trains an ensemble. Inputs are scaled to mean 0 and deviation 1; outputs are divided by their mean
/// magnitude under the percentage loss, which keeps it a percentage, left alone under the cross-entropy,
/// whose networks end in a softmax, and standardised under any other. Beside a line, what it leaves is
/// standardised: a network ends where its training did, a line goes on. The numbers are float while training.
/// @throws std::invalid_argument if the design does not fit the samples or a setting is out of range;
///   std::domain_error if a loss ceases to be finite; TrainingEnded when `progress` ended it.
Ensemble TrainEnsemble(const Samples& samples, const EnsembleSettings& settings,
                       const TrainingProgress& progress = {});

}  // namespace strainwave::analysis::prediction
