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

// Of BIC. A further term that brings less hides nothing; and what brings that much, and as much of it beside
// a further term, is there and was found.
constexpr double kHidesNothing = 100.0;
constexpr double kWorthSearching = 200.0;
constexpr double kAsMuch = 0.9;

VibrationSolution FitTerms(const VibrationSolver& solver, const std::vector<VibrationTerm>& terms) {
  VibrationSolution solution = solver.Solve(terms);
  return terms.empty() ? solution : solver.Refine(std::move(solution), 1);
}

std::size_t HashOf(std::span<const double> weights) {
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(weights.data()), weights.size_bytes()});
}

// The model with one more term, all refined together: the search has held the others.
VibrationSolution Together(const VibrationResidual& residual, VibrationTerm term) {
  std::vector<VibrationTerm> terms = residual.base().terms;
  terms.push_back(std::move(term));
  VibrationSolution solution = residual.solver().Solve(std::move(terms), &residual.base());
  const bool alone = residual.base().terms.empty() && HasColumns(solution.terms.back().form);
  return alone ? solution : residual.solver().Refine(std::move(solution), 2);
}

// The same term, but for what a fit moves it by when another one comes or goes.
bool IsNear(const VibrationSamples& samples, const VibrationTerm& x, const VibrationTerm& y) {
  if (x.cause != y.cause || x.form != y.form ||
      x.nonlinear_parameters.size() != y.nonlinear_parameters.size() || x.lines.size() != y.lines.size() ||
      x.observable != y.observable) {
    return false;
  }
  const std::vector<VibrationNonlinearParameter> nonlinear_parameters = NonlinearParametersOf(samples, x);
  for (std::size_t s = 0; s < nonlinear_parameters.size(); ++s) {
    if (std::abs(x.nonlinear_parameters[s] - y.nonlinear_parameters[s]) > nonlinear_parameters[s].step)
      return false;
  }
  return true;
}

// What is found beside the one set is found beside the other.
bool AreNear(const VibrationSamples& samples, const std::vector<VibrationTerm>& a,
             const std::vector<VibrationTerm>& b) {
  return std::ranges::equal(
      a, b, [&](const VibrationTerm& x, const VibrationTerm& y) { return IsNear(samples, x, y); });
}

bool IsNearlyWithin(const VibrationSamples& samples, const std::vector<VibrationTerm>& fewer,
                    const std::vector<VibrationTerm>& terms) {
  return std::ranges::all_of(fewer, [&](const VibrationTerm& x) {
    return std::ranges::any_of(terms, [&](const VibrationTerm& y) { return IsNear(samples, x, y); });
  });
}

VibrationSolution WithFound(const VibrationBase& base, VibrationTerm term, std::size_t cause) {
  term.cause = cause;  // there may be two of a kind
  return Together(base.residual, std::move(term));
}

}  // namespace

std::optional<VibrationSolution> Beside(const VibrationResidual& residual, VibrationCause kind,
                                        std::size_t cause) {
  std::optional<TermFit> fit = SearchCause(residual, kind, cause);
  if (!fit) return std::nullopt;
  return Together(residual, std::move(fit->term));
}

VibrationBase::VibrationBase(const VibrationSamples& samples, std::span<const double> weights,
                             const std::vector<VibrationTerm>& terms, VibrationSearched& cached,
                             const ParallelFor& parallel)
    : searched(cached),
      solver(samples, weights, parallel),
      solution(FitTerms(solver, terms)),
      residual(samples, solver, solution) {
  searched.bic = solution.bic();
}

VibrationSearched& VibrationSearches::SearchedBeside(const VibrationSamples& samples,
                                                     std::size_t weights_hash,
                                                     const std::vector<VibrationTerm>& terms) {
  const std::vector<double> state = PackTerms(terms);
  VibrationSearched searched{weights_hash, state, 0.0, {}};
  // The last ones first.
  for (VibrationSearched& other : searched_) {
    if (other.weights_hash != weights_hash) continue;
    if (other.state == state) return other;
    if (searched.found.empty() && AreNear(samples, UnpackTerms(other.state), terms))
      searched.found = other.found;
  }
  return searched_.emplace_front(std::move(searched));
}

std::shared_ptr<VibrationBase> VibrationSearches::BaseOf(const VibrationSamples& samples,
                                                         std::span<const double> weights,
                                                         const std::vector<VibrationTerm>& terms) {
  const std::lock_guard lock(mutex_);
  VibrationSearched& searched = SearchedBeside(samples, HashOf(weights), terms);
  const auto known = std::ranges::find(
      bases_, &searched, [](const std::shared_ptr<VibrationBase>& base) { return &base->searched; });
  if (known != bases_.end()) {
    bases_.splice(bases_.begin(), bases_, known);
    return bases_.front();
  }
  bases_.push_front(std::make_shared<VibrationBase>(samples, weights, terms, searched, parallel_));
  if (bases_.size() > kMostBases) bases_.pop_back();
  return bases_.front();
}

std::optional<VibrationSearches::Searched> VibrationSearches::FoundBesideFewer(const VibrationBase& base,
                                                                               VibrationCause kind,
                                                                               std::size_t cause) {
  struct Fewer {
    std::vector<VibrationTerm> terms;
    double bic{};
    VibrationFound found;
  };
  const std::vector<VibrationTerm>& terms = base.solution.terms;
  std::vector<Fewer> all;
  {
    const std::lock_guard lock(mutex_);
    for (const VibrationSearched& other : searched_) {
      const auto found = other.found.find(kind);
      if (other.weights_hash == base.searched.weights_hash && found != other.found.end())
        all.push_back({UnpackTerms(other.state), other.bic, found->second});
    }
  }
  for (const Fewer& fewer : all) {
    if (fewer.terms.size() + 1 != terms.size() ||
        !IsNearlyWithin(base.residual.samples(), fewer.terms, terms))
      continue;
    const auto& [term, gain] = fewer.found;
    if (gain <= 0.0 && fewer.bic - base.searched.bic < kHidesNothing)
      return Searched{fewer.found, std::nullopt};
    if (!term || gain < kWorthSearching) continue;
    VibrationSolution solution = WithFound(base, *term, cause);
    const double gain_now = base.searched.bic - solution.bic();
    if (gain_now > kAsMuch * gain) return Searched{{term, gain_now}, std::move(solution)};
  }
  return std::nullopt;
}

VibrationSearches::Searched VibrationSearches::Search(const VibrationBase& base, VibrationCause kind,
                                                      std::size_t cause) {
  if (std::optional<Searched> known = FoundBesideFewer(base, kind, cause)) return std::move(*known);
  std::optional<TermFit> fit = SearchCause(base.residual, kind, cause);
  if (!fit) return {};
  VibrationSolution solution = Together(base.residual, fit->term);
  const double gain = base.searched.bic - solution.bic();
  return {{std::move(fit->term), gain}, std::move(solution)};
}

std::optional<VibrationSolution> VibrationSearches::Find(VibrationBase& base, VibrationCause kind,
                                                         std::size_t cause) {
  const std::pair<const VibrationSearched*, VibrationCause> own{&base.searched, kind};
  Searched now;
  VibrationFound& found = now.found;
  bool known = false;
  {
    std::unique_lock lock(mutex_);
    search_ended_.wait(lock, [&] { return !running_.contains(own); });
    const auto before = base.searched.found.find(kind);
    known = before != base.searched.found.end();
    if (known) found = before->second;
    if (!known) running_.insert(own);
  }
  if (!known) {
    const auto end = [&] {
      const std::lock_guard lock(mutex_);
      if (known) base.searched.found[kind] = found;
      running_.erase(own);
      search_ended_.notify_all();
    };
    try {
      now = Search(base, kind, cause);
      known = true;
    } catch (...) {
      end();
      throw;
    }
    end();
  }
  if (now.solution || !found.term) return std::move(now.solution);
  return WithFound(base, std::move(*found.term), cause);
}

}  // namespace strainwave::analysis::diagnosis
