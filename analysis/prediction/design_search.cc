// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/design_search.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <stdexcept>

namespace strainwave::analysis::prediction {
namespace {

Trial Try(const Samples& samples, const Candidate& candidate, const std::vector<Split>& folds,
          EnsembleSettings settings) {
  settings.design = candidate.DesignFor(static_cast<int>(samples.features.cols()),
                                        static_cast<int>(samples.targets.cols()));
  settings.training.weight_decay = candidate.weight_decay;
  settings.training.parallel = InTurn;
  settings.members = 1;
  settings.parallel = InTurn;
  const CrossFit cross = CrossPredict(samples, settings, folds);
  const std::vector<double> errors = FoldErrors_percent(samples, folds, cross);
  double sum = 0.0;
  double squares = 0.0;
  for (const double error : errors) sum += error;
  const auto n = static_cast<double>(errors.size());
  for (const double error : errors) squares += (error - sum / n) * (error - sum / n);
  return {candidate, networks::Network(settings.design).parameter_count(), sum / n,
          errors.size() > 1 ? std::sqrt(squares / (n - 1.0) / n) : 0.0};
}

}  // namespace

std::string Candidate::Name() const {
  return fmt::format("{}, decay {:g}", fmt::join(widths, "-"), weight_decay);
}

networks::Design Candidate::DesignFor(int inputs, int outputs) const {
  networks::Design design{{1, inputs}, {}};
  for (const int width : widths) design.layers.push_back(networks::Dense{width, networks::Activation::kTanh});
  design.layers.push_back(networks::Dense{outputs, networks::Activation::kLinear});
  return design;
}

std::vector<Candidate> UsualCandidates() {
  std::vector<Candidate> candidates;
  for (const std::vector<int>& widths :
       {std::vector{16}, std::vector{64}, std::vector{64, 32}, std::vector{128, 64, 32}}) {
    for (const double decay : {1e-3, 1e-2}) candidates.push_back({widths, decay});
  }
  return candidates;
}

std::vector<Trial> SearchDesigns(const Samples& samples, const std::vector<Candidate>& candidates,
                                 const std::vector<Split>& folds, const EnsembleSettings& settings,
                                 const FitProgress& progress) {
  if (candidates.empty() || folds.empty()) {
    throw std::invalid_argument(fmt::format("{} candidates and {} folds (expected at least one of each)",
                                            candidates.size(), folds.size()));
  }
  std::vector<Trial> trials(candidates.size());
  std::atomic<bool> go_on{true};
  std::mutex telling;
  double done = 0.0;
  settings.parallel(candidates.size(), [&](std::size_t i) {
    if (!go_on) return;
    trials[i] = Try(samples, candidates[i], folds, settings);
    const std::lock_guard lock(telling);
    done += 1.0;
    if (progress && !progress(done / static_cast<double>(candidates.size()))) go_on = false;
  });
  if (!go_on) throw TrainingEnded();
  std::ranges::stable_sort(trials, {}, &Trial::error_percent);
  const double good_enough = trials.front().error_percent + trials.front().standard_error_percent;
  auto winner = trials.begin();
  for (auto trial = trials.begin(); trial != trials.end(); ++trial) {
    if (trial->error_percent <= good_enough && trial->parameters < winner->parameters) winner = trial;
  }
  std::rotate(trials.begin(), winner, winner + 1);
  return trials;
}

}  // namespace strainwave::analysis::prediction
