// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// −ln p of a likelihood ratio that so many numbers bring by chance, each by noise alone as much as a square
/// of a normal variate.
double ImprobabilityOf(double likelihood_ratio, double numbers);

/// The same of what a term explains beside a model, by its numbers. BIC charges all of them by the length of
/// the record, and would rather have a train without its change, or another one, than what is least likely to
/// be chance. The likelihood knows the noise's colour all over a broad resonance, not only at its centre.
double ImprobabilityOf(const VibrationResidual& residual, const TermFit& fit);

/// Logarithm of how many choices of so many out of so many there are.
double LogChoices(std::size_t chosen, std::size_t of);

/// Of forms of one cause with different numbers of numbers: the one that is least likely to be chance. BIC
/// charges each number by the length of the record, and would rather have the strongest channel alone than a
/// line that is observable in all of them.
class LeastLikelyChance {
 public:
  explicit LeastLikelyChance(const VibrationResidual& residual) : residual_(residual) {}

  /// @param log_search_locations  logarithm of how many such forms there were to choose from
  void Take(TermFit fit, double log_search_locations);

  /// The fit as it is, and without the channels in which its term is not observable.
  void TakeWithAndWithoutUnobservable(TermFit fit, double log_search_locations);

  const std::optional<TermFit>& fit() const& { return best_; }
  std::optional<TermFit> fit() && { return std::move(best_); }

 private:
  const VibrationResidual& residual_;
  std::optional<TermFit> best_;
  double improbability_{};
};

}  // namespace strainwave::analysis::diagnosis
