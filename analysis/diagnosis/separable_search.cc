// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/separable_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "analysis/diagnosis/known_before.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Of moving what is moved only where it pays: rounds before it is given up, where it is that far from paying.
constexpr int kFirstRounds = 4;
constexpr double kNearlyPays = 0.5;  // of one number's price

// Whether what people read of a solution's last term lies where its rule expects it.
bool IsAsExpected(const TermSet& set, const CauseRule& rule, const SeparableSolution& solution) {
  std::vector<double> numbers = solution.coefficients.back();
  numbers.insert(numbers.end(), solution.nonlinear_parameters.back().begin(),
                 solution.nonlinear_parameters.back().end());
  const auto width = static_cast<Eigen::Index>(numbers.size());
  const std::vector<ParameterValue> values =
      set.terms.back()->describe(numbers, Eigen::MatrixXd::Zero(width, width));
  return std::ranges::all_of(rule.parameters, [&](const ParameterRule& expected) {
    const auto value = std::ranges::find(values, expected.name, &ParameterValue::name);
    return value == values.end() || (value->value >= expected.low && value->value <= expected.high);
  });
}

}  // namespace

SearchedNonlinearParameters SearchNonlinearParameters(const SeparableModel& model, const TermSet& set,
                                                      const CauseRule& rule, std::span<const double> weights,
                                                      const SeparableSolution& before) {
  std::vector<double> residual(model.measured);
  for (std::size_t i = 0; i < residual.size(); ++i)
    residual[i] -= before.predicted(static_cast<Eigen::Index>(i));
  const SeparableProblem problem(set, model.measured, weights);
  const SeparableTerm& searched = *set.terms.back();
  std::vector<std::vector<std::vector<double>>> starts;
  for (std::vector<double>& start : searched.starts({residual, weights})) {
    starts.push_back(before.nonlinear_parameters);
    starts.back().push_back(std::move(start));
  }
  std::vector<SeparableSolution> found;
  for (std::size_t k = 0; k < std::min(searched.most_starts, starts.size()); ++k)
    found.push_back(problem.Refine(problem.Solve(starts[k]), kSearchRounds));
  if (found.empty()) return {};
  std::ranges::stable_sort(found, {}, [&](const SeparableSolution& solution) {
    return std::pair(!IsAsExpected(set, rule, solution), solution.weighted_square_sum);
  });
  SearchedNonlinearParameters result{std::move(found.front()), {}};
  for (std::size_t k = 1; k < found.size(); ++k)
    result.others.push_back(std::move(found[k].nonlinear_parameters));
  const auto where_it_pays = [](const NonlinearParameterRange& range) {
    return range.moved == Moved::kWhereItPays;
  };
  if (std::ranges::any_of(searched.nonlinear_parameters, where_it_pays))
    std::ranges::move(starts, std::back_inserter(result.others));
  return result;
}

double UnpenalisedParameters(const TermSet& set, const SeparableSolution& solution,
                             std::span<const double> weights) {
  std::vector<Eigen::Index> known;
  std::vector<Eigen::Index> others;
  std::vector<double> ranges;
  Eigen::Index next = 0;
  for (const SeparableTerm* term : set.terms) {
    for (std::size_t c = 0; c < term->columns; ++c) others.push_back(next++);
    for (const NonlinearParameterRange& range : term->nonlinear_parameters) {
      const bool unpenalised = range.known && set.Moves(range);
      (unpenalised ? known : others).push_back(next++);
      if (unpenalised) ranges.push_back(range.high - range.low);
    }
  }
  if (known.empty()) return 0.0;
  const Eigen::Map<const Eigen::VectorXd> weight(weights.data(), static_cast<Eigen::Index>(weights.size()));
  const auto samples = static_cast<double>((weight.array() > 0.0).count());
  const Eigen::MatrixXd rows = weight.cwiseSqrt().asDiagonal() * Sensitivities(set, solution);
  return KnownBefore(rows(Eigen::all, known), rows(Eigen::all, others), ranges,
                     solution.weighted_square_sum / std::max(samples, 1.0), samples);
}

void Rest(const TermSet& set, std::vector<std::vector<double>>& nonlinear_parameters) {
  for (std::size_t t = 0; t < nonlinear_parameters.size(); ++t) {
    for (std::size_t s = 0; s < nonlinear_parameters[t].size(); ++s) {
      if (set.terms[t]->nonlinear_parameters[s].moved == Moved::kWhereItPays)
        nonlinear_parameters[t][s] = 0.0;
    }
  }
}

bool MoveWhereItPays(const SeparableModel& model, std::span<const double> weights,
                     const std::vector<std::vector<double>>& known, TermSet& set,
                     SeparableSolution& solution) {
  TermSet all = set;
  all.it_pays = true;
  if (all.moved_nonlinear_parameters() == set.moved_nonlinear_parameters()) return false;
  const SeparableProblem problem(all, model.measured, weights);
  const auto samples = static_cast<double>(std::ranges::count_if(weights, [](double w) { return w > 0.0; }));
  const auto ahead = [&](const SeparableSolution& moved) {
    return samples * std::log(solution.weighted_square_sum / moved.weighted_square_sum);
  };
  const auto pays = [&](const SeparableSolution& moved) {
    const double unpenalised =
        UnpenalisedParameters(all, moved, weights) - UnpenalisedParameters(set, solution, weights);
    const double charged =
        static_cast<double>(all.moved_nonlinear_parameters() - set.moved_nonlinear_parameters()) -
        unpenalised;
    return ahead(moved) > std::max(1.0, charged) * std::log(samples);
  };
  const auto take = [&](std::vector<std::vector<double>> nonlinear_parameters) {
    SeparableSolution moved = problem.Refine(problem.Solve(std::move(nonlinear_parameters)), kFirstRounds);
    // What is far from paying by now, of nonlinear parameters most of which are straight, does not come to it
    // any more.
    if (ahead(moved) < kNearlyPays * std::log(samples)) return false;
    moved = problem.Refine(std::move(moved), kFinalRounds - kFirstRounds);
    if (!pays(moved)) return false;
    solution = std::move(moved);
    return true;
  };
  // Where they paid before comes first: without such nonlinear parameters the others have left that place.
  std::vector<std::vector<double>> before = solution.nonlinear_parameters;
  std::ranges::copy(known, before.begin());
  std::vector<std::vector<double>> at_rest = before;
  Rest(set, at_rest);
  const bool paid = (before != at_rest && take(std::move(before))) || take(solution.nonlinear_parameters);
  if (paid) set = std::move(all);
  return paid;
}

SeparableSolution BestOf(const SeparableModel& model, std::span<const double> weights, const TermSet& set,
                         const CauseRule& rule, SeparableSolution best,
                         std::span<const std::vector<std::vector<double>>> others) {
  const SeparableProblem problem(set, model.measured, weights);
  const auto rank = [&](const SeparableSolution& solution) {
    return std::pair(!IsAsExpected(set, rule, solution), solution.weighted_square_sum);
  };
  for (const std::vector<std::vector<double>>& other : others) {
    SeparableSolution refined = problem.Refine(problem.Solve(other), kFinalRounds);
    if (rank(refined) < rank(best)) best = std::move(refined);
  }
  return best;
}

}  // namespace strainwave::analysis::diagnosis
