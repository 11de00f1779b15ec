// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "analysis/prediction/fit_predictor.h"

namespace strainwave::analysis::prediction {

/// A network to try.
struct Candidate {
  std::vector<int> widths;  // of the hidden dense layers, tanh
  double weight_decay{};

  std::string Name() const;  // "64-32, decay 0.001"
  networks::Design DesignFor(int inputs, int outputs) const;
};

/// How it did on records that it had not seen.
struct Trial {
  Candidate candidate;
  Eigen::Index parameters{};
  double error_percent{};           // over all folds, as `Contestant::Error_percent`
  double standard_error_percent{};  // from fold to fold
};

/// A handful of widths, depths and decays.
std::vector<Candidate> UsualCandidates();

/// Judges every candidate by the same folds, one network a fold; the best comes first, and of those within
/// one standard error of it the smallest network does (Breiman et al. 1984, section 3.4.3).
/// @param settings  all but design, decay and members; `parallel` spreads the candidates.
/// @throws std::invalid_argument if there are no candidates or folds; TrainingEnded.
std::vector<Trial> SearchDesigns(const Samples& samples, const std::vector<Candidate>& candidates,
                                 const std::vector<Split>& folds, const EnsembleSettings& settings,
                                 const FitProgress& progress = {});

}  // namespace strainwave::analysis::prediction
