// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/searches.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

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

// The model with one more term, all refined together: the search has held the others.
VibrationSolution Together(const VibrationRemainder& remainder, VibrationTerm term) {
  std::vector<VibrationTerm> terms = remainder.base().terms;
  terms.push_back(std::move(term));
  VibrationSolution solution = remainder.solver().Solve(std::move(terms), &remainder.base());
  const bool alone = remainder.base().terms.empty() && HasColumns(solution.terms.back().form);
  return alone ? solution : remainder.solver().Refine(std::move(solution), 2);
}

// The same terms, but for what a fit moves them by when another term comes or goes: what is found beside the
// one is found beside the other.
bool AreNear(const VibrationSamples& samples, const std::vector<VibrationTerm>& a,
             const std::vector<VibrationTerm>& b) {
  return std::ranges::equal(a, b, [&](const VibrationTerm& x, const VibrationTerm& y) {
    if (x.cause != y.cause || x.form != y.form || x.shapes.size() != y.shapes.size() ||
        x.lines.size() != y.lines.size() || x.heard != y.heard) {
      return false;
    }
    const std::vector<VibrationShape> shapes = ShapesOf(samples, x);
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      if (std::abs(x.shapes[s] - y.shapes[s]) > shapes[s].step) return false;
    }
    return true;
  });
}

}  // namespace

std::optional<VibrationSolution> Beside(const VibrationRemainder& remainder, VibrationCause kind,
                                        std::size_t cause) {
  std::optional<TermFit> fit = SearchCause(remainder, kind, cause);
  if (!fit) return std::nullopt;
  return Together(remainder, std::move(fit->term));
}

VibrationBase::VibrationBase(const VibrationSamples& samples, std::span<const double> weights,
                             const std::vector<VibrationTerm>& terms, VibrationSearched& remembered)
    : searched(remembered),
      solver(samples, weights),
      solution(FitTerms(solver, terms)),
      remainder(samples, solver, solution) {}

VibrationSearched& VibrationSearches::SearchedBeside(const VibrationSamples& samples,
                                                     std::size_t weights_hash,
                                                     const std::vector<VibrationTerm>& terms) {
  const std::vector<double> state = PackTerms(terms);
  VibrationSearched searched{weights_hash, state, {}};
  // The last ones first.
  for (VibrationSearched& other : searched_) {
    if (other.weights_hash != weights_hash) continue;
    if (other.state == state) return other;
    if (searched.found.empty() && AreNear(samples, UnpackTerms(other.state), terms))
      searched.found = other.found;
  }
  return searched_.emplace_front(std::move(searched));
}

VibrationBase& VibrationSearches::BaseOf(const VibrationSamples& samples, std::span<const double> weights,
                                         const std::vector<VibrationTerm>& terms) {
  VibrationSearched& searched = SearchedBeside(samples, HashOf(weights), terms);
  const auto known =
      std::ranges::find(bases_, &searched, [](const VibrationBase& base) { return &base.searched; });
  if (known != bases_.end()) {
    bases_.splice(bases_.begin(), bases_, known);
    return bases_.front();
  }
  bases_.emplace_front(samples, weights, terms, searched);
  if (bases_.size() > kMostBases) bases_.pop_back();
  return bases_.front();
}

std::optional<VibrationSolution> VibrationSearches::Find(VibrationBase& base, VibrationCause kind,
                                                         std::size_t cause) const {
  const auto known = base.searched.found.find(kind);
  if (known == base.searched.found.end()) {
    std::optional<VibrationSolution> solution = Beside(base.remainder, kind, cause);
    auto& remembered = base.searched.found[kind];
    if (solution) remembered = solution->terms.back();
    return solution;
  }
  if (!known->second) return std::nullopt;
  VibrationTerm term = *known->second;
  term.cause = cause;  // there may be two of a kind
  return Together(base.remainder, std::move(term));
}

}  // namespace strainwave::analysis::diagnosis
