// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "analysis/prediction/conformal.h"
#include "analysis/prediction/ensemble.h"
#include "analysis/prediction/novelty.h"
#include "analysis/prediction/samples.h"
#include "analysis/prediction/scores.h"
#include "analysis/prediction/splits.h"

namespace strainwave::analysis::prediction {

/// An ensemble that knows how far to trust itself.
struct FittedPredictor {
  Ensemble ensemble;
  Eigen::RowVectorXd residual;  // root mean square error of each output on records that no fit had seen
  ConformalBand band;
  Novelty novelty;           // of scaled inputs
  Eigen::RowVectorXd least;  // of each input, in training: the range in which it was seen
  Eigen::RowVectorXd greatest;

  struct Prediction {
    Eigen::MatrixXd value;
    Eigen::MatrixXd half_width;  // of the interval
    Eigen::VectorXd distance;    // over the limit: above 1 the record lies outside what was trained on
  };
  Prediction Predict(const Eigen::MatrixXd& features) const;
};

/// Progress of a long fit: share done, 0 to 1; false ends it.
using FitProgress = std::function<bool(double share)>;

/// What a fit left out in turn: predictions of every record by an ensemble that had not seen its fold.
struct CrossFit {
  Eigen::MatrixXd predicted;
  Eigen::MatrixXd spread;    // of the members
  Eigen::VectorXd distance;  // novelty, over its limit
};
CrossFit CrossPredict(const Samples& samples, const EnsembleSettings& settings,
                      const std::vector<Split>& splits, const FitProgress& progress = {});

/// A predictor, and what its calibration saw on the way: the honest errors of a k-fold.
struct Fit {
  FittedPredictor predictor;
  std::vector<Split> folds;
  CrossFit cross;
  /// Share of the records, one an output, inside intervals that were calibrated without their fold; empty for
  /// classes.
  Eigen::RowVectorXd left_out_coverage;
};

/// Fits on all samples. The intervals are calibrated by cross-fitting: whole specimens (blocks of time where
/// there is one) are left out in turn, predicted by an ensemble that has not seen them, and their errors over
/// √(residual² + member spread²) give the factor. Source: see `conformal.h`; Barber et al. (2021) for the
/// cross-fitting. A predictor of classes has no intervals: the band stays at zero.
/// @param folds  2 or more.
/// @throws std::invalid_argument as TrainEnsemble and CalibrateBand; std::runtime_error when progress ended
///   it.
Fit FitPredictor(const Samples& samples, const EnsembleSettings& settings, double coverage, int folds,
                 const FitProgress& progress = {});

/// How one kind of predictor did on records that it had not seen.
struct Contestant {
  std::string name;
  std::vector<OutputScore> scores;  // none for classes
  Eigen::MatrixXi confusion;        // empty but for classes

  /// The mean percentage error of all outputs; of classes, the share of records given a wrong one.
  double Error_percent() const noexcept;
};
/// @param predicted  of the samples, as their targets are.
Contestant Judge(std::string name, const Samples& samples, const Eigen::MatrixXd& predicted);

/// The error of each fold (`Contestant::Error_percent`) by networks that had not seen it.
std::vector<double> FoldErrors_percent(const Samples& samples, const std::vector<Split>& folds,
                                       const CrossFit& cross);

/// The network of a cross-fit beside what it has to beat, every record predicted by what had not seen its
/// fold.
std::vector<Contestant> CompareFolds(const Samples& samples, const std::vector<Split>& folds,
                                     const CrossFit& cross);

/// Whole specimens where there are several, blocks of time where there is one.
std::vector<Split> HonestFolds(const Samples& samples, int folds);

/// The network beside what it has to beat, trained and tested on the two sides of one split: a linear ridge,
/// a forest, one that sees only the cycle number (not for classes), and the mean of the
/// training records, which for classes is the commonest one.
struct Comparison {
  std::vector<Contestant> contestants;
  Ensemble network;  // the one that was trained for it
};
Comparison Compare(const Samples& samples, const Split& split, const EnsembleSettings& settings,
                   const FitProgress& progress = {});

}  // namespace strainwave::analysis::prediction
