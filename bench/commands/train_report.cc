// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/train_report.h"
#include "bench/commands/output.h"

#include <algorithm>
#include <set>

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace strainwave::bench {
namespace {

namespace prediction = analysis::prediction;

void PrintFeatures(const TrainingData& data, const FilterSummary& filter) {
  const std::size_t campaigns =
      static_cast<std::size_t>(std::ranges::count_if(data.sources, [](const TrainingSource& source) {
        return std::filesystem::is_directory(source.folder);
      }));
  const std::size_t files = data.sources.size() - campaigns;
  std::vector<std::string> from;
  if (campaigns > 0) from.push_back(fmt::format("{} campaign{}", campaigns, campaigns == 1 ? "" : "s"));
  if (files > 0) from.push_back(fmt::format("{} record{}", files, files == 1 ? "" : "s"));
  ToStdout("{} {} of {}", data.samples.size(), data.recipe.window == WindowLength{} ? "records" : "windows",
           fmt::join(from, " and "));
  if (data.recipe.window.turns > 0)
    ToStdout(", each of {} turns of the input shaft", data.recipe.window.turns);
  if (data.recipe.window.samples > 0) ToStdout(", each of {} samples", data.recipe.window.samples);
  ToStdout("; {} of {} vibration features kept (|r| filter on {} records)", filter.vibration_kept,
           filter.vibration_features, filter.records);
  if (filter.torque_features > 0) {
    ToStdout("; {} of {} torque features say nothing new, and none is used",
             filter.torque_features - filter.torque_kept, filter.torque_features);
  }
  ToStdout("\n");
  ToStdout("trained at {}\n", data.recipe.envelope.Text());
}

void PrintSearch(const std::vector<prediction::Trial>& trials) {
  if (trials.empty()) return;
  ToStdout(
      "\nsearch on the training side of the first split (one network a fold; the smallest within one "
      "standard error of the best is taken):\n  {:<28} {:>11} {:>18}\n",
      "hidden layers", "parameters", "error, %");
  for (const prediction::Trial& trial : trials) {
    ToStdout("  {:<28} {:>11} {:>11.3f} ± {:.3f}{}\n", trial.candidate.Name(), trial.parameters,
             trial.error_percent, trial.standard_error_percent, &trial == &trials.front() ? "  taken" : "");
  }
}

void PrintValues(const std::vector<prediction::Contestant>& contestants,
                 const std::vector<std::string>& outputs) {
  ToStdout("  {:<20}", "MAPE, %");
  for (const std::string& output : outputs) ToStdout(" {:>15}", output);
  ToStdout(" {:>8}\n", "mean");
  for (const prediction::Contestant& contestant : contestants) {
    ToStdout("  {:<20}", contestant.name);
    for (const prediction::OutputScore& score : contestant.scores) ToStdout(" {:>15.3f}", score.mape_percent);
    ToStdout(" {:>8.3f}\n", contestant.Error_percent());
  }
}

void PrintAccuracies(const std::vector<prediction::Contestant>& contestants) {
  ToStdout("  {:<20} {:>12}\n", "", "accuracy, %");
  for (const prediction::Contestant& contestant : contestants) {
    ToStdout("  {:<20} {:>12.2f}\n", contestant.name, 100.0 - contestant.Error_percent());
  }
}

void PrintConfusion(const Eigen::MatrixXi& confusion, const std::vector<std::string>& classes) {
  ToStdout("  {:<24}", "own class, given as");
  for (const std::string& name : classes) ToStdout(" {:>14}", name);
  ToStdout("\n");
  for (Eigen::Index own = 0; own < confusion.rows(); ++own) {
    ToStdout("  {:<24}", classes[static_cast<std::size_t>(own)]);
    for (Eigen::Index given = 0; given < confusion.cols(); ++given)
      ToStdout(" {:>14}", confusion(own, given));
    ToStdout("\n");
  }
}

// A class that one specimen alone has is not known to the network that is tested on it.
void PrintLonelyClasses(const prediction::Samples& samples) {
  if (prediction::SpecimenCount(samples) < 2) return;
  for (std::size_t k = 0; k < samples.outputs.size(); ++k) {
    std::set<int> specimens;
    for (Eigen::Index row = 0; row < samples.size(); ++row) {
      if (samples.targets(row, static_cast<Eigen::Index>(k)) > 0.0) {
        specimens.insert(samples.specimen[static_cast<std::size_t>(row)]);
      }
    }
    if (specimens.size() > 1) continue;
    ToStdout(
        "  note: {} stands in one file or specimen alone: left out, nothing teaches it; another record of "
        "it would tell\n",
        samples.outputs[k]);
  }
}

void PrintFolds(const TrainingData& data, const FoldResult& folds) {
  ToStdout("\n{} folds of {}, each predicted by what had not seen it:\n", folds.error_percent.size(),
           folds.of);
  if (data.samples.classes) {
    ToStdout("  accuracy {:.2f} %; by fold", 100.0 - folds.contestants.front().Error_percent());
    for (const double error : folds.error_percent) ToStdout(" {:.1f}", 100.0 - error);
    ToStdout("\n");
    PrintConfusion(folds.contestants.front().confusion, data.samples.outputs);
    PrintLonelyClasses(data.samples);
    return;
  }
  PrintValues(folds.contestants, data.samples.outputs);
  ToStdout("  mean MAPE of the network {:.3f} %; by fold", folds.contestants.front().Error_percent());
  for (const double error : folds.error_percent) ToStdout(" {:.3f}", error);
  ToStdout("\n");
}

void PrintIntervals(const std::vector<std::string>& outputs, const prediction::FittedPredictor& fitted,
                    const FoldResult& folds) {
  ToStdout("\n{:.0f} % intervals, in root mean square errors of records that no network had seen:\n",
           100.0 * fitted.band.coverage);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    ToStdout("  {:<20} ±{:.2f} × {:.4g}; calibrated without each fold in turn they held {:.1f} %\n",
             outputs[i], fitted.band.factor(column), fitted.residual(column),
             100.0 * folds.interval_coverage(column));
  }
  if (!fitted.band.guaranteed) {
    ToStdout("  too few reducers for a guarantee: these are the widest errors that were seen\n");
  }
}

void PrintCurve(const std::vector<prediction::LearningPoint>& curve, const std::string& split) {
  if (curve.empty()) return;
  ToStdout(
      "\nhow few measured records would do (error in % on {}; chosen actively: each as far as can be from "
      "all "
      "chosen before):\n  {:>8} {:>10} {:>10}\n",
      split, "records", "actively", "evenly");
  for (const prediction::LearningPoint& point : curve) {
    ToStdout("  {:>8} {:>10.3f} {:>10.3f}\n", point.count, point.active_percent, point.even_percent);
  }
}

}  // namespace

void PrintTrainingReport(const TrainingData& data, const TrainingOutcome& outcome) {
  const bool classes = data.samples.classes;
  PrintFeatures(data, outcome.filter);
  PrintSearch(outcome.trials);
  for (const SplitResult& split : outcome.splits) {
    ToStdout("\n{} ({}): trained on {}, tested on {} records\n", split.name, split.meaning, split.train,
             split.test);
    classes ? PrintAccuracies(split.contestants) : PrintValues(split.contestants, data.samples.outputs);
  }
  if (outcome.predictor) PrintFolds(data, outcome.folds);
  PrintCurve(outcome.curve, outcome.splits.front().name);
  if (!classes && outcome.predictor)
    PrintIntervals(data.samples.outputs, outcome.predictor->fitted, outcome.folds);
  ToStdout("\nwhat the inputs are worth (rise of the {} when they are shuffled):\n",
           classes ? "share of wrong classes" : "mean MAPE");
  for (const prediction::Importance& importance : outcome.importances) {
    ToStdout("  {:<40} {:+.3f} ± {:.3f} %\n", importance.name, importance.error_rise_percent,
             importance.standard_error_percent);
  }
  constexpr std::size_t kMostNotes = 10;
  for (std::size_t i = 0; i < std::min(kMostNotes, data.notes.size()); ++i)
    ToStdout("note: {}\n", data.notes[i]);
  if (data.notes.size() > kMostNotes) {
    ToStdout("note: and {} more, all in predictor.json\n", data.notes.size() - kMostNotes);
  }
}

}  // namespace strainwave::bench
