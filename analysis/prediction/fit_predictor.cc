// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/fit_predictor.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>

#include "analysis/prediction/forest.h"
#include "analysis/prediction/ridge.h"

namespace strainwave::analysis::prediction {
namespace {

constexpr double kInsideShare = 0.99;  // of unseen records that are called known

// Records that share their errors: those of a specimen; where there is one, those of a block of time.
std::vector<int> GroupsOf(const Samples& samples) {
  if (SpecimenCount(samples) > 1) return samples.specimen;
  constexpr std::size_t kBlocks = 40;
  std::vector<std::size_t> order(samples.cycle.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return samples.cycle[i]; });
  std::vector<int> group(order.size());
  for (std::size_t place = 0; place < order.size(); ++place) {
    group[order[place]] = static_cast<int>(place * kBlocks / order.size());
  }
  return group;
}

Eigen::MatrixXd SpreadOf(const Eigen::MatrixXd& members, const Eigen::RowVectorXd& residual) {
  return (members.array().square().rowwise() + residual.array().square()).sqrt();
}

Eigen::RowVectorXd RmsOf(const Eigen::MatrixXd& error) {
  return error.array().square().colwise().mean().sqrt().max(1e-300);
}

// Members may be trained side by side: what counts is how many epochs are done in all.
TrainingProgress ShareOf(const FitProgress& progress, const EnsembleSettings& settings, double begin,
                         double end) {
  if (!progress) return {};
  struct Counter {
    std::mutex mutex;
    double epochs{};
  };
  const double all = static_cast<double>(settings.members) * settings.training.epochs;
  return [&progress, begin, end, all, counter = std::make_shared<Counter>()](int, int, double) {
    const std::lock_guard telling(counter->mutex);
    counter->epochs += 1.0;
    return progress(begin + (end - begin) * counter->epochs / all);
  };
}

// What a predictor can know from the number of the cycle alone.
Eigen::MatrixXd AgeOf(const Samples& samples, double last) {
  Eigen::MatrixXd age(samples.size(), 4);
  for (Eigen::Index row = 0; row < samples.size(); ++row) {
    const double share = samples.cycle[static_cast<std::size_t>(row)] / last;
    age.row(row) << share, share * share, share * share * share, std::sqrt(std::max(0.0, share));
  }
  return age;
}

// What a network has to beat, and what it says of the test.
struct Rival {
  std::string name;
  Eigen::MatrixXd predicted;
};
std::vector<Rival> RivalsOn(const Samples& train, const Samples& test) {
  constexpr int kTrees = 100;
  const Scaler scaler = Standardizing(train.features);
  const Eigen::MatrixXd inputs = scaler.Apply(train.features);
  const Eigen::MatrixXd unseen = scaler.Apply(test.features);
  std::vector<Rival> rivals;
  rivals.push_back({"ridge", FitRidge(inputs, train.targets, train.specimen).Predict(unseen)});
  rivals.push_back({"forest", Forest(inputs, train.targets, kTrees).Predict(unseen)});
  if (!train.classes) {
    const double last = std::max(1.0, *std::ranges::max_element(train.cycle));
    const Ridge by_age = FitRidge(AgeOf(train, last), train.targets, train.specimen);
    rivals.push_back({"cycle number alone", by_age.Predict(AgeOf(test, last))});
  }
  rivals.push_back(
      {train.classes ? "commonest class" : "mean", train.targets.colwise().mean().replicate(test.size(), 1)});
  return rivals;
}

}  // namespace

FittedPredictor::Prediction FittedPredictor::Predict(const Eigen::MatrixXd& features) const {
  Ensemble::Prediction raw = ensemble.Predict(features);
  const Eigen::MatrixXd spread = SpreadOf(raw.spread, residual);
  return {.value = std::move(raw.mean),
          .half_width = spread.array().rowwise() * band.factor.array(),
          .distance = novelty.Distance(ensemble.input.Apply(features)) / novelty.limit};
}

CrossFit CrossPredict(const Samples& samples, const EnsembleSettings& settings,
                      const std::vector<Split>& splits, const FitProgress& progress) {
  CrossFit all{Eigen::MatrixXd::Zero(samples.size(), samples.targets.cols()),
               Eigen::MatrixXd::Zero(samples.size(), samples.targets.cols()),
               Eigen::VectorXd::Zero(samples.size())};
  for (std::size_t k = 0; k < splits.size(); ++k) {
    const double begin = static_cast<double>(k) / static_cast<double>(splits.size());
    const double end = static_cast<double>(k + 1) / static_cast<double>(splits.size());
    const Samples seen = Rows(samples, splits[k].train);
    const Samples unseen = Rows(samples, splits[k].test);
    const Ensemble ensemble = TrainEnsemble(seen, settings, ShareOf(progress, settings, begin, end));
    const Ensemble::Prediction predicted = ensemble.Predict(unseen.features);
    const Eigen::MatrixXd inputs = ensemble.input.Apply(seen.features);
    const Eigen::VectorXd distance =
        FitNovelty(inputs, inputs, kInsideShare).Distance(ensemble.input.Apply(unseen.features));
    for (std::size_t i = 0; i < splits[k].test.size(); ++i) {
      const auto from = static_cast<Eigen::Index>(i);
      const Eigen::Index to = splits[k].test[i];
      all.predicted.row(to) = predicted.mean.row(from);
      all.spread.row(to) = predicted.spread.row(from);
      all.distance(to) = distance(from);
    }
  }
  return all;
}

Fit FitPredictor(const Samples& samples, const EnsembleSettings& settings, double coverage, int folds,
                 const FitProgress& progress) {
  const double cross_share = static_cast<double>(folds) / (folds + 1.0);
  FitProgress first;
  if (progress) first = [&](double share) { return progress(cross_share * share); };
  const std::vector<Split> splits = HonestFolds(samples, folds);
  CrossFit cross = CrossPredict(samples, settings, splits, first);

  FittedPredictor fitted{
      .ensemble = TrainEnsemble(samples, settings, ShareOf(progress, settings, cross_share, 1.0)),
      .residual = RmsOf(samples.targets - cross.predicted),
      .band = {.coverage = 0.0,
               .factor = Eigen::RowVectorXd::Zero(samples.targets.cols()),
               .guaranteed = false},
      .novelty = {},
      .least = samples.features.colwise().minCoeff(),
      .greatest = samples.features.colwise().maxCoeff()};
  Eigen::RowVectorXd left_out_coverage;
  if (!samples.classes) {
    const Eigen::MatrixXd spread = SpreadOf(cross.spread, fitted.residual);
    fitted.band = CalibrateBand(samples.targets, cross.predicted, spread, GroupsOf(samples), coverage);
    left_out_coverage =
        LeftOutCoverage(samples.targets, cross.predicted, spread, GroupsOf(samples), splits, coverage);
    // What blocks of one life say, they say of that life alone.
    fitted.band.guaranteed = fitted.band.guaranteed && SpecimenCount(samples) > 1;
  }
  const Eigen::MatrixXd inputs = fitted.ensemble.input.Apply(samples.features);
  fitted.novelty = FitNovelty(inputs, inputs, kInsideShare);
  // The limit by records that the covariance had not seen, as every later record is.
  fitted.novelty.limit = std::max(fitted.novelty.limit, DistanceKept(cross.distance, kInsideShare));
  return {std::move(fitted), splits, std::move(cross), std::move(left_out_coverage)};
}

double Contestant::Error_percent() const noexcept {
  return scores.empty() ? 100.0 - Accuracy_percent(confusion) : MeanMape_percent(scores);
}

Contestant Judge(std::string name, const Samples& samples, const Eigen::MatrixXd& predicted) {
  if (samples.classes) return {std::move(name), {}, Confusion(samples.targets, predicted)};
  return {std::move(name), ScoresOf(Values(samples, samples.targets), Values(samples, predicted)), {}};
}

std::vector<double> FoldErrors_percent(const Samples& samples, const std::vector<Split>& folds,
                                       const CrossFit& cross) {
  std::vector<double> errors_percent;
  for (const Split& fold : folds) {
    errors_percent.push_back(
        Judge("network", Rows(samples, fold.test), cross.predicted(fold.test, Eigen::all)).Error_percent());
  }
  return errors_percent;
}

std::vector<Contestant> CompareFolds(const Samples& samples, const std::vector<Split>& folds,
                                     const CrossFit& cross) {
  std::vector<Rival> all;
  for (const Split& fold : folds) {
    const std::vector<Rival> of_fold = RivalsOn(Rows(samples, fold.train), Rows(samples, fold.test));
    for (std::size_t k = 0; k < of_fold.size(); ++k) {
      if (k == all.size()) all.push_back({of_fold[k].name, samples.targets});
      all[k].predicted(fold.test, Eigen::all) = of_fold[k].predicted;
    }
  }
  std::vector<Contestant> contestants{Judge("network", samples, cross.predicted)};
  for (const Rival& rival : all) contestants.push_back(Judge(rival.name, samples, rival.predicted));
  return contestants;
}

std::vector<Split> HonestFolds(const Samples& samples, int folds) {
  return SpecimenCount(samples) > 1 ? SplitsBySpecimen(samples.specimen, folds)
                                    : SplitsByBlocks(samples.specimen, samples.cycle, folds);
}

Comparison Compare(const Samples& samples, const Split& split, const EnsembleSettings& settings,
                   const FitProgress& progress) {
  const Samples train = Rows(samples, split.train);
  const Samples test = Rows(samples, split.test);
  Ensemble ensemble = TrainEnsemble(train, settings, ShareOf(progress, settings, 0.0, 1.0));
  std::vector<Contestant> contestants{Judge("network", test, ensemble.Predict(test.features).mean)};
  for (const Rival& rival : RivalsOn(train, test))
    contestants.push_back(Judge(rival.name, test, rival.predicted));
  return {std::move(contestants), std::move(ensemble)};
}

}  // namespace strainwave::analysis::prediction
