// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/searches.h"

#include <algorithm>
#include <string_view>

namespace strainwave::analysis::diagnosis {
namespace {

// Each holds its columns and spectra: some megabytes for a long record.
constexpr std::size_t kMostBases = 4;

VibrationSolution FitTerms(const VibrationSolver& solver, const std::vector<VibrationTerm>& terms) {
  VibrationSolution solution = solver.Solve(terms);
  return terms.empty() ? solution : solver.Refine(std::move(solution), 1);
}

std::size_t HashOf(std::span<const double> weights) {
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(weights.data()), weights.size_bytes()});
}

}  // namespace

VibrationBase::VibrationBase(const VibrationSamples& samples, std::span<const double> weights,
                             std::size_t hash, const std::vector<VibrationTerm>& terms)
    : weights_hash(hash),
      state(PackTerms(terms)),
      solver(samples, weights),
      solution(FitTerms(solver, terms)),
      remainder(samples, solver, solution) {}

VibrationBase& VibrationSearches::BaseOf(const VibrationSamples& samples, std::span<const double> weights,
                                         const std::vector<VibrationTerm>& terms) {
  const std::size_t hash = HashOf(weights);
  const std::vector<double> state = PackTerms(terms);
  const auto known = std::ranges::find_if(
      bases_, [&](const VibrationBase& base) { return base.weights_hash == hash && base.state == state; });
  if (known != bases_.end()) {
    bases_.splice(bases_.begin(), bases_, known);
  } else {
    bases_.emplace_front(samples, weights, hash, terms);
    if (bases_.size() > kMostBases) bases_.pop_back();
  }
  return bases_.front();
}

std::optional<VibrationSolution> VibrationSearches::Find(VibrationBase& base, VibrationCause kind,
                                                         std::size_t cause) const {
  const auto known = base.found.find(kind);
  if (known != base.found.end()) {
    if (!known->second) return std::nullopt;
    std::vector<VibrationTerm> terms = *known->second;
    terms.back().cause = cause;  // there may be two of a kind
    return base.solver.Solve(std::move(terms), &base.solution);
  }
  std::optional<VibrationSolution> solution = SearchCause(base.remainder, kind, cause);
  if (solution && !base.solution.terms.empty()) solution = base.solver.Refine(std::move(*solution), 2);
  auto& remembered = base.found[kind];
  if (solution) remembered = solution->terms;
  return solution;
}

}  // namespace strainwave::analysis::diagnosis
