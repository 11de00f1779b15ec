// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "analysis/diagnosis/vibration/solver.h"
#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// What a search came to.
struct VibrationFound {
  std::optional<VibrationTerm> term;  // before it is refined beside the others; nothing where it found none
  double gain{};                      // in BIC, of the model refined with it
};

/// A set of terms under one set of weights, and what was looked for beside it.
struct VibrationSearched {
  std::size_t weights_hash;
  std::vector<double> state;  // of the terms
  double bic{};               // of their fit
  std::map<VibrationCause, VibrationFound> found;
};

/// That set, fitted, and what it leaves.
struct VibrationBase {
  VibrationSearched& searched;
  VibrationSolver solver;
  VibrationSolution solution;
  VibrationResidual residual;

  VibrationBase(const VibrationSamples& samples, std::span<const double> weights,
                const std::vector<VibrationTerm>& terms, VibrationSearched& cached,
                const ParallelFor& parallel);
  VibrationBase(const VibrationBase&) = delete;
  VibrationBase& operator=(const VibrationBase&) = delete;
};

/// A model with the best form of one more cause, all terms refined together; nothing where the cause has no
/// support of its own.
std::optional<VibrationSolution> Beside(const VibrationResidual& residual, VibrationCause kind,
                                        std::size_t cause);

/// Caches searches: selecting, exchanging and naming of rivals ask for the same cause beside the same
/// model several times, or beside one that differs only by what its fit was started from. Several threads may
/// search beside one base; what they find does not depend on who is first.
class VibrationSearches {
 public:
  /// @param parallel  over parts of one search
  explicit VibrationSearches(ParallelFor parallel) : parallel_(std::move(parallel)) {}

  std::shared_ptr<VibrationBase> BaseOf(const VibrationSamples& samples, std::span<const double> weights,
                                        const std::vector<VibrationTerm>& terms);

  /// The base with a cause of this kind; nothing where the cause has no support of its own.
  std::optional<VibrationSolution> Find(VibrationBase& base, VibrationCause kind, std::size_t cause);

 private:
  VibrationSearched& SearchedBeside(const VibrationSamples& samples, std::size_t weights_hash,
                                    const std::vector<VibrationTerm>& terms);
  struct Searched {
    VibrationFound found;
    std::optional<VibrationSolution> solution;  // of the base with the term found, where a search came by it
  };
  Searched Search(const VibrationBase& base, VibrationCause kind, std::size_t cause);
  std::optional<Searched> FoundBesideFewer(const VibrationBase& base, VibrationCause kind, std::size_t cause);

  ParallelFor parallel_;
  std::mutex mutex_;  // of all below, and of what was found beside a set
  std::condition_variable search_ended_;
  std::set<std::pair<const VibrationSearched*, VibrationCause>> running_;
  std::list<VibrationSearched> searched_;            // all
  std::list<std::shared_ptr<VibrationBase>> bases_;  // a few, the last used first
};

}  // namespace strainwave::analysis::diagnosis
