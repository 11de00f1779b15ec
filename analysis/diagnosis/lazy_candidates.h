// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <vector>

#include "analysis/diagnosis/candidates.h"

namespace strainwave::analysis::diagnosis {

/// Candidates of one round of a selection after the other, of a study whose searches are long. What came
/// nowhere near the best in the round before does hardly better beside one effect more, and is fitted only
/// when it may decide (lazy evaluation of a greedy selection; Minoux, Optimization Techniques, Lecture Notes
/// in Control and Information Sciences 7 (1978) 234). Of other studies all are fitted at once.
class LazyCandidates {
 public:
  using Begins = std::function<void(std::size_t cause)>;

  /// @param begins  as for FitCandidates
  LazyCandidates(const Judge& judge, Begins begins) : judge_(judge), begins_(std::move(begins)) {}

  /// Those that may come near the strongest.
  std::vector<Candidate> Strongest(const ScoredModel& model);

  /// Adds the others, where one of them may come near the chosen one, or nothing was chosen.
  /// @returns whether there were any.
  bool AddOthers(const ScoredModel& model, const Candidate* chosen, std::vector<Candidate>& candidates);

 private:
  struct LastFit {
    double likelihood_ratio{};  // for white noise, beside the model of its round
    double log_likelihood{};    // of that model
  };

  // Of a likelihood ratio: that of an effect as large as it was, beside a model that leaves less.
  double Expected(std::size_t cause, const ScoredModel& model) const;
  void Fit(const ScoredModel& model, double least, std::vector<Candidate>& candidates);

  const Judge& judge_;
  Begins begins_;
  std::map<std::size_t, LastFit> last_;     // by cause
  std::map<std::size_t, double> expected_;  // of those not fitted in this round
};

}  // namespace strainwave::analysis::diagnosis
