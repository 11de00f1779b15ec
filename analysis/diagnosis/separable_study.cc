// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/separable_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/noise_likelihood.h"
#include "analysis/diagnosis/open_numbers.h"
#include "analysis/diagnosis/recent.h"
#include "analysis/diagnosis/separable_search.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Numbers of a solution in the order of TermSet: coefficients, then nonlinear parameters, term after term.
std::vector<double> NumbersOf(const SeparableSolution& solution) {
  std::vector<double> numbers;
  for (std::size_t t = 0; t < solution.coefficients.size(); ++t) {
    numbers.insert(numbers.end(), solution.coefficients[t].begin(), solution.coefficients[t].end());
    numbers.insert(numbers.end(), solution.nonlinear_parameters[t].begin(),
                   solution.nonlinear_parameters[t].end());
  }
  return numbers;
}

TermSet NominalTerms(const SeparableModel& model, FitPurpose purpose) {
  TermSet set;
  set.purpose = purpose;
  set.samples = model.measured.size();
  for (const SeparableTerm& term : model.nominal) set.terms.push_back(&term);
  return set;
}

// Nonlinear parameters of a cause in a fit; empty if the fit does not have it.
std::vector<double> KnownNonlinearParameters(const SeparableModel& model, const ModelFit* fit,
                                             std::size_t cause) {
  std::vector<double> nonlinear_parameters;
  if (fit == nullptr) return nonlinear_parameters;
  std::size_t at = 0;
  for (const SeparableTerm& term : model.nominal) at += term.columns + term.nonlinear_parameters.size();
  for (const std::size_t known : fit->causes) {
    const SeparableTerm& term = model.causes[known];
    if (known == cause) {
      for (std::size_t s = 0; s < term.nonlinear_parameters.size(); ++s)
        nonlinear_parameters.push_back(fit->state[at + term.columns + s]);
      return nonlinear_parameters;
    }
    at += term.columns + term.nonlinear_parameters.size();
  }
  return nonlinear_parameters;
}

// Weighted least squares of a term set over the whole of a record, and what is known of its noise.
struct Record {
  const SeparableModel& model;
  const TermSet& set;
  std::span<const double> weights;

  std::vector<double> LeftBy(const Eigen::VectorXd& predicted) const {
    std::vector<double> left(model.measured);
    for (std::size_t i = 0; i < left.size(); ++i) left[i] -= predicted(static_cast<Eigen::Index>(i));
    return left;
  }
  NoiseFit NoiseOf(const SeparableSolution& solution) const {
    const auto [low, high] = std::ranges::minmax(model.measured);
    return FitNoise(LeftBy(solution.predicted), weights, model.segments, model.largest_noise_order,
                    std::max(high - low, 1e-300));
  }
  // With what was known before of some numbers: a shape that the record says nothing of is as uncertain as
  // its range, and no more; one that the fit does not move is none of its numbers.
  FitErrors ErrorsOf(const SeparableSolution& solution) const {
    Eigen::VectorXd ridge =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(set.coefficients() + set.nonlinear_parameters()));
    Eigen::Index at = 0;
    for (const SeparableTerm* term : set.terms) {
      const auto columns = static_cast<Eigen::Index>(term->columns);
      ridge.segment(at, columns).setConstant(term->ridge);
      at += columns + static_cast<Eigen::Index>(term->nonlinear_parameters.size());
    }
    FitErrors errors = ErrorsOfFit(Sensitivities(set, solution), model.measured, solution.predicted, weights,
                                   model.segments, model.largest_noise_order, ridge);
    at = 0;
    for (const SeparableTerm* term : set.terms) {
      at += static_cast<Eigen::Index>(term->columns);
      for (const NonlinearParameterRange& range : term->nonlinear_parameters) {
        const double before = (range.high - range.low) * (range.high - range.low) / 12.0;
        const Eigen::VectorXd with = errors.covariance.col(at);
        if (range.known) errors.covariance -= with * with.transpose() / (before + with(at));
        const bool open = !errors.open.row(at).isZero(0.0);
        if (open && set.Moves(range)) errors.covariance(at, at) = before;
        errors.open.row(at++).setZero();
      }
    }
    return errors;
  }
};

// Solutions with other optima of one term's search, each with its likelihood over the given one's, as far as
// the record does not exclude them.
std::vector<std::pair<double, SeparableSolution>> OtherOptima(const Record& record,
                                                              const SeparableSolution& solution,
                                                              std::size_t term) {
  constexpr double kNegligible = -14.0;  // of −2 log-likelihood: a thousandth
  const SeparableTerm& moving = *record.set.terms[term];
  Eigen::MatrixXd columns(solution.predicted.size(), static_cast<Eigen::Index>(moving.columns));
  moving.fill(solution.nonlinear_parameters[term], columns);
  const Eigen::Map<const Eigen::VectorXd> coefficients(solution.coefficients[term].data(), columns.cols());
  const std::vector<double> left = record.LeftBy(solution.predicted - columns * coefficients);
  const SeparableProblem problem(record.set, record.model.measured, record.weights);
  const NoiseFit own = record.NoiseOf(solution);
  std::vector<std::pair<double, SeparableSolution>> others;
  for (std::vector<double>& start : moving.starts({left, record.weights})) {
    std::vector<std::vector<double>> nonlinear_parameters = solution.nonlinear_parameters;
    nonlinear_parameters[term] = std::move(start);
    SeparableSolution other = problem.Refine(problem.Solve(std::move(nonlinear_parameters)), kSearchRounds);
    const double ahead = LikelihoodRatio(record.NoiseOf(other), own);
    if (ahead > kNegligible) others.emplace_back(std::exp(0.5 * std::min(ahead, 0.0)), std::move(other));
  }
  return others;
}

// Numbers of one term as people read them.
std::vector<ParameterValue> DescribeTerm(const TermSet& set, const SeparableSolution& solution,
                                         const Eigen::MatrixXd& covariance, std::size_t term) {
  Eigen::Index at = 0;
  for (std::size_t t = 0; t < term; ++t)
    at += static_cast<Eigen::Index>(set.terms[t]->columns + set.terms[t]->nonlinear_parameters.size());
  std::vector<double> numbers = solution.coefficients[term];
  numbers.insert(numbers.end(), solution.nonlinear_parameters[term].begin(),
                 solution.nonlinear_parameters[term].end());
  const auto width = static_cast<Eigen::Index>(numbers.size());
  return set.terms[term]->describe(numbers, covariance.block(at, at, width, width));
}

// The errors of one term's numbers, over all optima of its search that the record leaves open.
void WidenByOtherOptima(const Record& record, const SeparableSolution& solution, std::size_t term,
                        std::vector<ParameterValue>& described) {
  std::vector<OtherModel> others;
  for (const auto& [likelihood, other] : OtherOptima(record, solution, term))
    others.push_back({likelihood, DescribeTerm(record.set, other, record.ErrorsOf(other).covariance, term)});
  WidenErrors(others, described);
}

// Numbers of the fit as people read them, term after term.
void Describe(const Record& record, const SeparableSolution& solution, ModelFit& fit) {
  const auto numbers = static_cast<Eigen::Index>(fit.state.size());
  const FitPurpose purpose = record.set.purpose;
  const FitErrors errors = purpose == FitPurpose::kCompare
                               ? FitErrors{Eigen::MatrixXd::Zero(numbers, numbers), {}}
                               : record.ErrorsOf(solution);
  OpenNumbers open(errors.open);
  const std::size_t nominal_terms = record.model.nominal.size();
  Eigen::Index first = 0;
  for (std::size_t t = 0; t < record.set.terms.size(); ++t) {
    const SeparableTerm& term = *record.set.terms[t];
    std::vector<ParameterValue> values = DescribeTerm(record.set, solution, errors.covariance, t);
    const auto width = static_cast<Eigen::Index>(term.columns + term.nonlinear_parameters.size());
    const Eigen::MatrixXd own = errors.covariance.block(first, first, width, width);
    open.Mark(
        Eigen::Map<const Eigen::VectorXd>(fit.state.data() + first, width), first,
        [&](const Eigen::VectorXd& moved) {
          return term.describe({moved.data(), static_cast<std::size_t>(moved.size())}, own);
        },
        values);
    first += width;
    if (t < nominal_terms) {
      fit.nominal.insert(fit.nominal.end(), values.begin(), values.end());
      continue;
    }
    if (purpose == FitPurpose::kReport && !record.set.terms[t]->nonlinear_parameters.empty())
      WidenByOtherOptima(record, solution, t, values);
    fit.cause_parameters.push_back(std::move(values));
  }
  fit.open = open.Words();
}

// Candidates are fitted one after the other beside the same known terms, whose columns are the same each
// time.
void CacheColumns(SeparableTerm& term, std::size_t samples) {
  constexpr std::size_t kMostNumbers = std::size_t{1} << 20;  // 8 MB a term
  constexpr std::size_t kMostFills = 64;
  const std::size_t most =
      std::min(kMostFills, kMostNumbers / std::max<std::size_t>(1, samples * term.columns));
  if (term.nonlinear_parameters.empty() || most < 2 * term.nonlinear_parameters.size() + 1) return;
  using Filled = Recent<std::vector<double>, Eigen::MatrixXd>;
  term.fill = [fill = std::move(term.fill), recent = std::make_shared<Filled>(most)](
                  std::span<const double> nonlinear_parameters, Eigen::Ref<Eigen::MatrixXd> design) {
    design = recent->Get({nonlinear_parameters.begin(), nonlinear_parameters.end()}, [&] {
      Eigen::MatrixXd columns(design.rows(), design.cols());
      fill(nonlinear_parameters, columns);
      return columns;
    });
  };
}

}  // namespace

double WeightedResidual::MeanSquare() const {
  double sum = 0.0;
  double weight = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += weights[i] * values[i] * values[i];
    weight += weights[i];
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

SeparableStudy::SeparableStudy(SeparableModel model) : model_(std::move(model)) {
  if (model_.causes.size() != model_.rules.size()) {
    throw std::invalid_argument(fmt::format("a separable study has {} causes and {} rules (expected as many)",
                                            model_.causes.size(), model_.rules.size()));
  }
  for (const Regressor& regressor : model_.regressors) {
    if (regressor.values.size() != model_.measured.size()) {
      throw std::invalid_argument(
          fmt::format("regressor {} has {} values, the response {} (expected as many)", regressor.name,
                      regressor.values.size(), model_.measured.size()));
    }
  }
  for (SeparableTerm& term : model_.causes) CacheColumns(term, model_.measured.size());
}

std::vector<UserQuantity> SeparableStudy::Quantities(const Eigen::VectorXd& predicted) const {
  return model_.quantities ? model_.quantities(predicted) : std::vector<UserQuantity>{};
}

ModelFit SeparableStudy::Fit(std::span<const std::size_t> cause_indices, std::span<const double> weights,
                             const ModelFit* start, FitPurpose purpose) const {
  // Known terms first, then one after the other those whose nonlinear parameters have to be searched for.
  TermSet set = NominalTerms(model_, purpose);
  std::vector<std::vector<double>> nonlinear_parameters(model_.nominal.size());
  std::vector<std::size_t> searched;
  std::vector<std::size_t> order;
  for (const std::size_t cause : cause_indices) {
    std::vector<double> known = KnownNonlinearParameters(model_, start, cause);
    if (known.size() < model_.causes[cause].nonlinear_parameters.size()) {
      searched.push_back(cause);
      continue;
    }
    set.terms.push_back(&model_.causes[cause]);
    nonlinear_parameters.push_back(std::move(known));
    order.push_back(cause);
  }
  const std::vector<std::vector<double>> known_nonlinear_parameters = nonlinear_parameters;
  if (purpose != FitPurpose::kReport) Rest(set, nonlinear_parameters);
  std::optional<SeparableProblem> problem(std::in_place, set, model_.measured, weights);
  SeparableSolution solution = problem->Solve(std::move(nonlinear_parameters));
  if (!searched.empty()) problem.reset();                // of another set
  std::vector<std::vector<std::vector<double>>> others;  // of the last search
  for (const std::size_t cause : searched) {
    set.terms.push_back(&model_.causes[cause]);
    order.push_back(cause);
    SearchedNonlinearParameters found =
        SearchNonlinearParameters(model_, set, model_.rules[cause], weights, solution);
    if (!found.best) return {};
    solution = std::move(*found.best);
    others = std::move(found.others);
  }
  if (set.nonlinear_parameters() > 0) {
    if (!problem) problem.emplace(set, model_.measured, weights);
    solution = problem->Refine(std::move(solution), kFinalRounds);
    if (MoveWhereItPays(model_, weights, known_nonlinear_parameters, set, solution) && !others.empty())
      solution = BestOf(model_, weights, set, model_.rules[searched.back()], std::move(solution), others);
  }

  // Back into ascending order of the causes.
  std::vector<std::size_t> rank(order.size());
  std::iota(rank.begin(), rank.end(), std::size_t{0});
  std::sort(rank.begin(), rank.end(), [&](std::size_t a, std::size_t b) { return order[a] < order[b]; });
  TermSet sorted_set = NominalTerms(model_, purpose);
  sorted_set.it_pays = set.it_pays;
  std::vector<std::vector<double>> sorted_nonlinear_parameters(model_.nominal.size());
  ModelFit fit;
  for (const std::size_t i : rank) {
    sorted_set.terms.push_back(set.terms[model_.nominal.size() + i]);
    sorted_nonlinear_parameters.push_back(solution.nonlinear_parameters[model_.nominal.size() + i]);
    const SeparableTerm& term = *sorted_set.terms.back();
    if (term.log_search_locations)
      fit.log_search_locations += term.log_search_locations(sorted_nonlinear_parameters.back());
    fit.causes.push_back(order[i]);
  }
  if (!std::is_sorted(order.begin(), order.end())) {
    solution =
        SeparableProblem(sorted_set, model_.measured, weights).Solve(std::move(sorted_nonlinear_parameters));
  }
  fit.predicted = solution.predicted;
  fit.state = NumbersOf(solution);
  fit.free_parameters = static_cast<int>(sorted_set.coefficients() + sorted_set.moved_nonlinear_parameters());
  fit.known_before = UnpenalisedParameters(sorted_set, solution, weights);
  fit.usable = solution.predicted.allFinite();
  Describe({model_, sorted_set, weights}, solution, fit);
  return fit;
}

std::vector<double> SeparableStudy::ModelUncertainty(const ModelFit& fit) const {
  Eigen::ArrayXd variance;
  const std::span<const double> numbers(fit.state);
  std::size_t at = 0;
  const auto add = [&](const SeparableTerm& term) {
    const std::size_t width = term.columns + term.nonlinear_parameters.size();
    if (term.model_uncertainty) {
      if (variance.size() == 0) variance.setZero(fit.predicted.size());
      variance += term.model_uncertainty(numbers.subspan(at, width)).array().square();
    }
    at += width;
  };
  for (const SeparableTerm& term : model_.nominal) add(term);
  for (const std::size_t cause : fit.causes) add(model_.causes[cause]);
  const Eigen::ArrayXd model_uncertainty = variance.sqrt();
  return {model_uncertainty.begin(), model_uncertainty.end()};
}

Eigen::VectorXd SeparableStudy::Predict(std::span<const ParameterValue> nominal,
                                        std::span<const NamedCause> causes) const {
  const auto samples = static_cast<Eigen::Index>(model_.measured.size());
  Eigen::VectorXd predicted = Eigen::VectorXd::Zero(samples);
  // `describe` of zeros tells the names, in order.
  const auto add = [&](const SeparableTerm& term, std::string_view owner,
                       std::span<const ParameterValue> given) {
    const std::size_t width = term.columns + term.nonlinear_parameters.size();
    std::vector<double> zeros(width, 0.0);
    for (std::size_t s = 0; s < term.nonlinear_parameters.size(); ++s)
      zeros[term.columns + s] = term.nonlinear_parameters[s].high;
    const auto square = static_cast<Eigen::Index>(width);
    std::vector<double> values;
    for (const ParameterValue& expected : term.describe(zeros, Eigen::MatrixXd::Zero(square, square))) {
      const auto match = std::find_if(given.begin(), given.end(), [&](const ParameterValue& value) {
        return value.name == expected.name;
      });
      if (match == given.end() && !expected.of_record) {
        throw std::invalid_argument(
            fmt::format("{} has no parameter {} (expected in {})", owner, expected.name, expected.unit));
      }
      values.push_back(match == given.end() ? 0.0 : match->value);
    }
    const std::vector<double> numbers = term.restore(values);
    Eigen::MatrixXd columns(samples, static_cast<Eigen::Index>(term.columns));
    term.fill({numbers.data() + term.columns, term.nonlinear_parameters.size()}, columns);
    predicted += columns * Eigen::Map<const Eigen::VectorXd>(numbers.data(), columns.cols());
  };
  for (const SeparableTerm& term : model_.nominal) add(term, "the nominal model", nominal);
  for (const NamedCause& cause : causes) {
    // A cause may come in two forms (a drift by time, or by temperature): the parameters tell which.
    const auto matches = [&](const CauseRule& rule) {
      return rule.name == cause.name &&
             std::all_of(rule.parameters.begin(), rule.parameters.end(), [&](const ParameterRule& expected) {
               return std::any_of(cause.parameters.begin(), cause.parameters.end(),
                                  [&](const ParameterValue& value) { return value.name == expected.name; });
             });
    };
    std::size_t index = 0;
    while (index < model_.rules.size() && !matches(model_.rules[index])) ++index;
    if (index == model_.rules.size()) {
      index = 0;
      while (index < model_.rules.size() && model_.rules[index].name != cause.name) ++index;
    }
    if (index == model_.rules.size()) {
      throw std::invalid_argument(fmt::format("there is no cause '{}' for records of this kind", cause.name));
    }
    add(model_.causes[index], cause.name, cause.parameters);
  }
  return predicted;
}

}  // namespace strainwave::analysis::diagnosis
