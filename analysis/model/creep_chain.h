// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

namespace strainwave::analysis::model {

/// Creep as a sum of Kelvin-Voigt elements: after a unit step the chain has gone to Σ weight · (1 −
/// e^(−t/τ)).
struct CreepChain {
  struct Element {
    double time_constant_s{};
    double weight{};
  };
  std::vector<Element> elements;
};

inline CreepChain ExponentialCreep(double time_constant_s) { return {{{time_constant_s, 1.0}}}; }

/// Time constants evenly over the logarithm from one to another: a box spectrum. At eight points; within
/// 0.001 of the whole step over three decades.
inline CreepChain BandOfCreep(double shortest_s, double longest_s) {
  constexpr int kElements = 8;
  const double ln_ratio = std::log(longest_s / shortest_s);
  CreepChain chain;
  for (int k = 0; k < kElements; ++k) {
    chain.elements.push_back({shortest_s * std::exp(ln_ratio * (k + 0.5) / kElements), 1.0 / kElements});
  }
  return chain;
}

/// Logarithmic creep, log₁₀(1 + t / t₀) up to `longest_s` (docs/effects.md E22). The weights follow from
///   ln(1 + t/t₀) = ∫ (1 − e^(−t/τ)) e^(−t₀/τ) d ln τ  (Frullani's integral with x = 1/τ),
/// taken at three points a decade; the slowest part of it is a straight line. Within 0.002 of a decade's
/// step.
inline CreepChain LogarithmicCreep(double onset_s, double longest_s) {
  constexpr double kLn10 = 2.302585092994046;
  constexpr double kStep = kLn10 / 3.0;
  constexpr double kForGood = 1000.0;  // an element this much slower than the rest has not bent yet
  CreepChain chain;
  double tau_s = 0.2 * onset_s;
  for (; tau_s < 10.0 * longest_s; tau_s *= std::exp(kStep)) {
    chain.elements.push_back({tau_s, std::exp(-onset_s / tau_s) * kStep / kLn10});
  }
  const double edge_s = tau_s * std::exp(-0.5 * kStep);
  chain.elements.push_back({kForGood * edge_s, kForGood / kLn10});
  return chain;
}

/// Share of the way to a new load that an element goes in a step, and the mean over the step of what is left
/// of the way, for loads that change in a straight line.
struct ElementStep {
  double gone{};       // 1 − e^(−dt/τ)
  double mean_gone{};  // 1 − (1 − e^(−dt/τ)) τ/dt
};
inline ElementStep StepOf(double time_constant_s, double step_s) noexcept {
  const double ratio = step_s / time_constant_s;
  if (!(ratio > 1e-6)) return {ratio, 0.5 * ratio};
  const double gone = -std::expm1(-ratio);
  return {gone, 1.0 - gone / ratio};
}

/// State of an element after a step in which its load goes from one value to another in a straight line;
/// exact.
inline double AdvanceElement(const ElementStep& step, double state, double from, double to) noexcept {
  return state + step.gone * (from - state) + step.mean_gone * (to - from);
}

}  // namespace strainwave::analysis::model
