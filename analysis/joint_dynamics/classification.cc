// SPDX-License-Identifier: Apache-2.0
#include "analysis/joint_dynamics/classification.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "analysis/joint_dynamics/excess_friction.h"
#include "analysis/prediction/class_scores.h"
#include "analysis/shuffle.h"

namespace strainwave::analysis::joint_dynamics {
namespace {

using Eigen::Index;
using prediction::BinaryKind;

// One fold of one split by one kind.
struct FoldTask {
  const FileSplit* split;
  int fold;
  BinaryKind kind;
};

std::vector<int> FoldOfSamples(const FileSplit& split, const std::vector<int>& file,
                               const std::vector<int>& faulty, std::uint64_t seed) {
  std::vector<int> folds(file.size());
  if (!split.by_samples) {
    for (std::size_t i = 0; i < file.size(); ++i) folds[i] = split.fold[static_cast<std::size_t>(file[i])];
    return folds;
  }
  std::vector<std::size_t> order(file.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937_64 random(seed);
  Shuffle(order, random);
  // Either class is dealt by itself, so that no fold takes all of one.
  std::ranges::stable_sort(order, {},
                           [&](std::size_t i) { return faulty[static_cast<std::size_t>(file[i])]; });
  for (std::size_t i = 0; i < order.size(); ++i) folds[order[i]] = static_cast<int>(i) % split.folds;
  return folds;
}

// Accuracy with its interval, confusion and area under the curve from the scores of the cases.
void Judge(double threshold, SplitScore& result) {
  result.cases = result.score.size();
  result.confusion = Eigen::MatrixXi::Zero(2, 2);
  for (std::size_t i = 0; i < result.cases; ++i)
    ++result.confusion(result.actual[i], result.score[i] > threshold ? 1 : 0);
  const double hits = result.confusion.trace();
  const auto cases = static_cast<double>(result.cases);
  result.accuracy = hits / cases;
  const prediction::ShareInterval interval = prediction::WilsonInterval(hits, cases);
  result.low = interval.low;
  result.high = interval.high;
  result.area_under_curve = prediction::AreaUnderCurve(result.actual, result.score);
}

SplitScore ScoreOf(const FileSplit& split, const std::vector<int>& file, const std::vector<int>& faulty,
                   const std::vector<double>& score, double threshold) {
  SplitScore result;
  double right = 0.0;
  for (std::size_t i = 0; i < file.size(); ++i)
    right += (score[i] > threshold) == (faulty[static_cast<std::size_t>(file[i])] == 1) ? 1.0 : 0.0;
  result.sample_accuracy = right / static_cast<double>(file.size());
  if (split.by_samples) {
    result.score = score;
    for (const int f : file) result.actual.push_back(faulty[static_cast<std::size_t>(f)]);
  } else {
    result.score.assign(faulty.size(), 0.0);
    std::vector<double> samples(faulty.size(), 0.0);
    for (std::size_t i = 0; i < file.size(); ++i) {
      result.score[static_cast<std::size_t>(file[i])] += score[i];
      samples[static_cast<std::size_t>(file[i])] += 1.0;
    }
    for (std::size_t f = 0; f < faulty.size(); ++f) result.score[f] /= std::max(1.0, samples[f]);
    result.actual = faulty;
  }
  Judge(threshold, result);
  return result;
}

}  // namespace

ScoreTable ScoreSplits(const std::vector<FileSplit>& splits,
                       const std::map<std::string, SampleFeatures>& features, const std::vector<int>& file,
                       const std::vector<int>& faulty, const std::vector<BinaryKind>& kinds,
                       const prediction::BinarySettings& settings, const ParallelFor& parallel) {
  std::vector<FoldTask> tasks;
  std::map<const FileSplit*, std::vector<int>> fold_of_sample;
  std::map<std::pair<const FileSplit*, BinaryKind>, std::vector<double>> scores;
  for (const FileSplit& split : splits) {
    const bool given = features.contains(split.name) || features.contains("");
    if (!split.impossible.empty() || !given) continue;
    fold_of_sample[&split] = FoldOfSamples(split, file, faulty, settings.seed);
    for (const BinaryKind kind : kinds) {
      scores[{&split, kind}].resize(file.size());
      for (int fold = 0; fold < split.folds; ++fold) tasks.push_back({&split, fold, kind});
    }
  }
  parallel(tasks.size(), [&](std::size_t t) {
    const FoldTask& task = tasks[t];
    const auto own = features.find(task.split->name);
    const Eigen::MatrixXd& all = (own != features.end() ? own : features.find(""))->second.For(task.fold);
    const std::vector<int>& folds = fold_of_sample.at(task.split);
    std::vector<Index> train;
    std::vector<Index> test;
    std::vector<int> actual;
    for (std::size_t i = 0; i < file.size(); ++i) {
      if (folds[i] == task.fold) {
        test.push_back(static_cast<Index>(i));
      } else {
        train.push_back(static_cast<Index>(i));
        actual.push_back(faulty[static_cast<std::size_t>(file[i])]);
      }
    }
    const Eigen::VectorXd score =
        prediction::TrainAndScore(task.kind, all(train, Eigen::all), actual, all(test, Eigen::all), settings);
    std::vector<double>& into = scores.at({task.split, task.kind});
    for (std::size_t i = 0; i < test.size(); ++i)
      into[static_cast<std::size_t>(test[i])] = score(static_cast<Index>(i));
  });
  ScoreTable table;
  for (const auto& [key, score] : scores) {
    table[key.first->name][std::string(prediction::NameOf(key.second))] =
        ScoreOf(*key.first, file, faulty, score, prediction::ThresholdOf(key.second));
  }
  return table;
}

ScoreTable ScoreExcessFriction(const std::vector<FileSplit>& splits,
                               const std::map<std::string, SampleFeatures>& nominal,
                               const std::vector<int>& file, const std::vector<int>& faulty, Index joints) {
  ScoreTable table;
  const auto files = static_cast<Index>(faulty.size());
  for (const FileSplit& split : splits) {
    const auto features = nominal.find(split.name);
    if (!split.impossible.empty() || split.by_samples || features == nominal.end()) continue;
    SplitScore result;
    result.actual = faulty;
    result.score.assign(faulty.size(), 0.0);
    bool possible = true;
    for (int fold = 0; fold < split.folds && possible; ++fold) {
      const Eigen::MatrixXd against = MeanAgainstMotion(features->second.For(fold), file, files, joints);
      std::vector<Index> healthy;
      for (std::size_t f = 0; f < faulty.size(); ++f) {
        if (split.fold[f] != fold && faulty[f] == 0) healthy.push_back(static_cast<Index>(f));
      }
      possible = static_cast<Index>(healthy.size()) >= kFewestHealthyFiles;
      if (!possible) break;
      const ExcessFriction excess = FitExcessFriction(against(healthy, Eigen::all));
      for (std::size_t f = 0; f < faulty.size(); ++f) {
        if (split.fold[f] == fold)
          result.score[f] = excess.Score(against.row(static_cast<Index>(f))) / excess.limit;
      }
    }
    if (!possible) continue;
    Judge(1.0, result);
    result.sample_accuracy = result.accuracy;
    table[split.name][kExcessFriction] = std::move(result);
  }
  return table;
}

}  // namespace strainwave::analysis::joint_dynamics
