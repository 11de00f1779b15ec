// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/solver.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "analysis/diagnosis/vibration/channel_fits.h"
#include "analysis/diagnosis/vibration/narrowband.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kLongestMissing = 8;
constexpr Index kRowsOfBlock = 1024;  // of four columns a channel and what predicts them, in the second cache

std::vector<double> NonlinearParametersFrom(const std::vector<VibrationTerm>& terms, std::size_t from) {
  std::vector<double> nonlinear_parameters;
  for (std::size_t t = from; t < terms.size(); ++t)
    nonlinear_parameters.insert(nonlinear_parameters.end(), terms[t].nonlinear_parameters.begin(),
                                terms[t].nonlinear_parameters.end());
  return nonlinear_parameters;
}

void SetNonlinearParametersFrom(std::vector<VibrationTerm>& terms, std::size_t from,
                                std::span<const double> nonlinear_parameters) {
  std::size_t s = 0;
  for (std::size_t t = from; t < terms.size(); ++t) {
    for (double& nonlinear_parameter : terms[t].nonlinear_parameters)
      nonlinear_parameter = nonlinear_parameters[s++];
  }
}

std::vector<VibrationNonlinearParameter> BoundsFrom(const VibrationSamples& samples,
                                                    const std::vector<VibrationTerm>& terms,
                                                    std::size_t from) {
  std::vector<VibrationNonlinearParameter> bounds;
  for (std::size_t t = from; t < terms.size(); ++t) {
    const std::vector<VibrationNonlinearParameter> own = NonlinearParametersOf(samples, terms[t]);
    bounds.insert(bounds.end(), own.begin(), own.end());
  }
  return bounds;
}

bool SameColumns(const VibrationTerm& a, const VibrationTerm& b) {
  return a.form == b.form && a.nonlinear_parameters == b.nonlinear_parameters && a.lines == b.lines;
}

bool IsNarrowband(const VibrationTerm& term) { return term.form == VibrationForm::kNarrowband; }

}  // namespace

double VibrationSolution::bic() const {
  return weight_sum * std::log(std::max(square_sum, 1e-300) / weight_sum) +
         free_parameters * std::log(weight_sum);
}

std::vector<double> MovedNonlinearParameters(std::vector<double> nonlinear_parameters,
                                             std::span<const VibrationNonlinearParameter> bounds,
                                             const SharedStep& step, double damping) {
  constexpr double kMostSteps = 20.0;
  MatrixXd damped = step.normal;
  damped.diagonal() *= 1.0 + damping;
  const VectorXd change = PseudoInverse(damped) * step.gradient;
  for (std::size_t s = 0; s < nonlinear_parameters.size(); ++s) {
    const double most = kMostSteps * bounds[s].step;
    nonlinear_parameters[s] =
        std::clamp(nonlinear_parameters[s] + std::clamp(change(static_cast<Index>(s)), -most, most),
                   bounds[s].low, bounds[s].high);
  }
  return nonlinear_parameters;
}

VibrationSolver::VibrationSolver(const VibrationSamples& samples, std::span<const double> weights,
                                 ParallelFor parallel)
    : samples_(samples), parallel_(std::move(parallel)), weights_(weights.begin(), weights.end()) {
  for (std::size_t r = 0; r < samples_.runs.size(); ++r) {
    for (const VibrationSegment& channel : samples_.runs[r].channels)
      run_channels_.push_back({r, &channel, false});
  }
  breaks_.assign(weights_.size(), 0);
  missing_.assign(weights_.size(), 0);
  for (const std::size_t first : samples_.segments) breaks_[first] = 1;
  for (std::size_t i = 0; i < weights_.size();) {
    std::size_t end = i;
    while (end < weights_.size() && !(weights_[end] > 0.0)) ++end;
    if (end - i <= kLongestMissing)
      std::fill(missing_.begin() + static_cast<std::ptrdiff_t>(i),
                missing_.begin() + static_cast<std::ptrdiff_t>(end), 1);
    i = end + 1;
  }
  for (RunChannel& own : run_channels_) {
    const auto first = missing_.begin() + static_cast<std::ptrdiff_t>(own.channel->first);
    const auto end = first + static_cast<std::ptrdiff_t>(samples_.runs[own.run].size());
    own.misses_samples = std::find(first, end, 1) != end;
  }
}

VibrationSolver::ChannelCombination VibrationSolver::CombinationOf(const VibrationTerm& narrowband,
                                                                   std::size_t run) const {
  const std::vector<VibrationSegment>& channels = samples_.runs[run].channels;
  std::size_t first = 0;
  for (std::size_t r = 0; r < run; ++r) first += samples_.runs[r].channels.size();
  ChannelCombination combined{VectorXd::Zero(static_cast<Index>(channels.size())), {}, {}};
  std::vector<char>& missing = combined.missing;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (narrowband.observable[first + c] == 0 || narrowband.nonlinear_parameters[2 + first + c] == 0.0)
      continue;
    combined.unit(static_cast<Index>(c)) = narrowband.nonlinear_parameters[2 + first + c];
    if (!run_channels_[first + c].misses_samples) continue;
    const auto own = missing_.begin() + static_cast<std::ptrdiff_t>(channels[c].first);
    missing.resize(samples_.runs[run].size());
    std::transform(missing.begin(), missing.end(), own, missing.begin(), std::bit_or<>());
  }
  const double size = combined.unit.norm();
  if (!(size > 0.0)) return combined;
  combined.unit /= size;
  combined.filter =
      FilterOf({narrowband.nonlinear_parameters[0], narrowband.nonlinear_parameters[1], 2.0 * std::log(size)},
               samples_.runs[run].period_s);
  return combined;
}

Predicted VibrationSolver::PredictedOf(std::span<const VibrationTerm> narrowband, std::size_t run,
                                       const VectorXd& left) const {
  const VibrationRun& own = samples_.runs[run];
  const auto first = static_cast<Index>(own.channels.front().first);
  const auto n = static_cast<Index>(own.size());
  const auto channels = static_cast<Index>(own.channels.size());
  Predicted predicted{MatrixXd(channels, static_cast<Index>(narrowband.size())), {}};
  std::vector<InnovationFilter> filters;
  std::vector<char> missing;
  for (const VibrationTerm& term : narrowband) {
    ChannelCombination combined = CombinationOf(term, run);
    predicted.units.col(static_cast<Index>(filters.size())) = combined.unit;
    filters.push_back(combined.filter);
    if (missing.empty()) missing = std::move(combined.missing);
  }
  // The channels of a record stand one after the other.
  predicted.along = Eigen::Map<const MatrixXd>(left.data() + first, n, channels) * predicted.units;
  Predict(filters, std::span(breaks_).subspan(static_cast<std::size_t>(first), own.size()), missing,
          predicted.along);
  return predicted;
}

void VibrationSolver::TakeOffPredicted(std::span<const VibrationTerm> terms,
                                       Eigen::Ref<MatrixXd> left) const {
  for (const VibrationTerm& term : terms) {
    if (!IsNarrowband(term)) continue;
    for (std::size_t r = 0; r < samples_.runs.size(); ++r) {
      const VibrationRun& run = samples_.runs[r];
      const auto n = static_cast<Index>(run.size());
      const ChannelCombination combined = CombinationOf(term, r);
      if (combined.unit.isZero(0.0)) continue;
      const std::span breaks = std::span(breaks_).subspan(run.channels.front().first, run.size());
      PredictionState state = PredictionState::Zero(4, left.cols());
      for (Index begin = 0; begin < n; begin += kRowsOfBlock) {
        const Index count = std::min(kRowsOfBlock, n - begin);
        const auto of_channel = [&](std::size_t c) {
          return left.middleRows(static_cast<Index>(run.channels[c].first) + begin, count);
        };
        const auto rows = [&](std::span<const char> of_run) {
          return of_run.empty()
                     ? of_run
                     : of_run.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(count));
        };
        MatrixXd together = MatrixXd::Zero(count, left.cols());
        for (std::size_t c = 0; c < run.channels.size(); ++c)
          together += combined.unit(static_cast<Index>(c)) * of_channel(c);
        Predict({&combined.filter, 1}, rows(breaks), rows(combined.missing), together, state);
        for (std::size_t c = 0; c < run.channels.size(); ++c) {
          const double unit = combined.unit(static_cast<Index>(c));
          if (unit != 0.0) of_channel(c) -= unit * together;
        }
      }
    }
  }
}

SharedColumns VibrationSolver::ColumnsOfChannel(const VibrationSolution& solution,
                                                std::size_t channel) const {
  const std::size_t run = run_channels_[channel].run;
  SharedColumns columns;
  columns.Add(samples_.runs[run].nominal);
  for (std::size_t t = 0; t < solution.terms.size(); ++t) {
    if (solution.terms[t].observable[channel] != 0) columns.Add(*solution.columns[run][t]);
  }
  return columns;
}

std::vector<VibrationSolver::Group> VibrationSolver::GroupsOf(std::span<const VibrationTerm> terms) const {
  std::vector<Group> groups;
  for (std::size_t c = 0; c < run_channels_.size(); ++c) {
    const bool repeats = c > 0 && run_channels_[c].run == run_channels_[c - 1].run &&
                         std::ranges::all_of(terms, [&](const VibrationTerm& term) {
                           return term.observable[c] == term.observable[c - 1];
                         });
    if (!repeats) groups.push_back({c, 0});
    ++groups.back().count;
  }
  return groups;
}

// The channels of a record stand one after the other.
Eigen::Map<const MatrixXd> VibrationSolver::SamplesOf(const Group& group, const double* all) const {
  const RunChannel& first = run_channels_[group.first];
  return {all + first.channel->first, static_cast<Index>(samples_.runs[first.run].size()),
          static_cast<Index>(group.count)};
}

VibrationSolution VibrationSolver::Solve(std::vector<VibrationTerm> terms,
                                         const VibrationSolution* previous) const {
  VibrationSolution solution;
  solution.terms = std::move(terms);
  const std::size_t runs = samples_.runs.size();
  solution.columns.assign(runs, std::vector<std::shared_ptr<const MatrixXd>>(solution.terms.size()));
  parallel_(runs * solution.terms.size(), [&](std::size_t i) {
    const std::size_t r = i % runs;
    const VibrationTerm& term = solution.terms[i / runs];
    std::shared_ptr<const MatrixXd>& columns = solution.columns[r][i / runs];
    for (std::size_t p = 0; previous != nullptr && p < previous->terms.size() && !columns; ++p) {
      if (SameColumns(previous->terms[p], term)) columns = previous->columns[r][p];
    }
    if (!columns) columns = std::make_shared<const MatrixXd>(FillTerm(samples_, r, term));
  });
  solution.weight_sum = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  for (const VibrationTerm& term : solution.terms) {
    const bool narrow = IsNarrowband(term);
    solution.free_parameters += narrow ? 2 : static_cast<int>(term.nonlinear_parameters.size());
    if (narrow)
      solution.free_parameters += static_cast<int>(
          std::count_if(term.observable.begin(), term.observable.end(), [](char h) { return h != 0; }));
  }
  for (const Group& group : GroupsOf(solution.terms)) {
    const SharedColumns columns = ColumnsOfChannel(solution, group.first);
    std::vector<ChannelFit> fits = FitChannels(columns, SamplesOf(group, samples_.measured.data()),
                                               SamplesOf(group, weights_.data()), parallel_);
    for (std::size_t k = 0; k < group.count; ++k) {
      VibrationSolution::Channel channel;
      channel.fit = std::move(fits[k]);
      const RunChannel& own = run_channels_[group.first + k];
      Index column = samples_.runs[own.run].nominal.cols();
      for (std::size_t t = 0; t < solution.terms.size(); ++t) {
        const bool observable = solution.terms[t].observable[group.first + k] != 0;
        channel.first.push_back(observable ? column : -1);
        if (observable) column += solution.columns[own.run][t]->cols();
      }
      solution.square_sum += channel.fit.square_sum;
      solution.free_parameters += static_cast<int>(columns.cols());
      solution.channels.push_back(std::move(channel));
    }
  }
  if (std::ranges::none_of(solution.terms, IsNarrowband)) return solution;
  solution.unexplained = Residual(solution);
  VectorXd left = solution.unexplained;
  TakeOffPredicted(solution.terms, left);
  solution.square_sum = 0.0;
  for (std::size_t c = 0; c < run_channels_.size(); ++c) {
    ChannelFit& fit = solution.channels[c].fit;
    const auto first = static_cast<Index>(run_channels_[c].channel->first);
    fit.residual = left.segment(first, fit.residual.size());
    fit.square_sum = Eigen::Map<const VectorXd>(weights_.data() + first, fit.residual.size())
                         .dot(fit.residual.cwiseAbs2());
    solution.square_sum += fit.square_sum;
  }
  return solution;
}

VectorXd VibrationSolver::Residual(const VibrationSolution& solution) const {
  VectorXd residual(static_cast<Index>(weights_.size()));
  for (std::size_t c = 0; c < run_channels_.size(); ++c) {
    const VectorXd& own = solution.channels[c].fit.residual;
    residual.segment(static_cast<Index>(run_channels_[c].channel->first), own.size()) = own;
  }
  return residual;
}

SharedStep VibrationSolver::StepOfPredicted(
    const VibrationSolution& solution, std::size_t from,
    const std::vector<VibrationNonlinearParameter>& nonlinear_parameters, MatrixXd derivatives) const {
  constexpr Index kSideBySide = 4;  // columns, which Predict works on together
  const VectorXd left = Residual(solution);
  // Before each narrow-band term: what those in front of it leave, which do not move with it.
  std::vector<VectorXd> before;
  VectorXd ahead = solution.unexplained;
  for (const VibrationTerm& term : solution.terms) {
    before.push_back(IsNarrowband(term) ? ahead : VectorXd());
    TakeOffPredicted({&term, 1}, ahead);
  }
  std::vector<std::function<void()>> tasks;
  Index s = 0;
  for (std::size_t t = from; t < solution.terms.size(); ++t) {
    const bool narrowband = IsNarrowband(solution.terms[t]);
    const Index end = s + static_cast<Index>(solution.terms[t].nonlinear_parameters.size());
    for (Index k = 0; narrowband && s < end; ++k, ++s) {
      tasks.push_back([&, t, k, s] {
        std::vector<VibrationTerm> moved(solution.terms.begin() + static_cast<std::ptrdiff_t>(t),
                                         solution.terms.end());
        const double by = 0.1 * nonlinear_parameters[static_cast<std::size_t>(s)].step;
        moved.front().nonlinear_parameters[static_cast<std::size_t>(k)] += by;
        VectorXd there = before[t];
        TakeOffPredicted(moved, there);
        derivatives.col(s) = (left - there) / by;
      });
    }
    for (; s < end; s = std::min(end, s + kSideBySide)) {
      tasks.push_back([&, s, count = std::min(kSideBySide, end - s)] {
        TakeOffPredicted(solution.terms, derivatives.middleCols(s, count));
      });
    }
  }
  parallel_(tasks.size(), [&](std::size_t i) { tasks[i](); });
  return StepOfDerivatives(derivatives, left, Eigen::Map<const VectorXd>(weights_.data(), derivatives.rows()),
                           parallel_);
}

SharedStep VibrationSolver::Step(VibrationSolution& solution, std::size_t from,
                                 const std::vector<VibrationNonlinearParameter>& nonlinear_parameters) const {
  // Slopes of the columns, once a run: the channels share them.
  const std::size_t terms = solution.terms.size() - from;
  std::vector<std::vector<MatrixXd>> slopes(samples_.runs.size(), std::vector<MatrixXd>(terms));
  parallel_(slopes.size() * terms, [&](std::size_t i) {
    const std::size_t r = i % slopes.size();
    const std::size_t t = i / slopes.size();
    const VibrationTerm& term = solution.terms[from + t];
    if (!IsNarrowband(term)) slopes[r][t] = FillSlopes(samples_, r, term, *solution.columns[r][from + t]);
  });
  const bool predicts = std::ranges::any_of(solution.terms, IsNarrowband);
  MatrixXd derivatives;  // of all channels; where narrow-band terms go on from them
  if (predicts)
    derivatives.resize(static_cast<Index>(weights_.size()), static_cast<Index>(nonlinear_parameters.size()));
  SharedStep step(static_cast<Index>(nonlinear_parameters.size()));
  for (const Group& group : GroupsOf(solution.terms)) {
    const std::size_t run = run_channels_[group.first].run;
    const SharedColumns columns = ColumnsOfChannel(solution, group.first);
    ChannelSlopes own{columns, SamplesOf(group, weights_.data()), {}, {}};
    for (std::size_t k = 0; k < group.count; ++k) own.fits.push_back(&solution.channels[group.first + k].fit);
    for (std::size_t t = 0; t < terms; ++t) {
      const VibrationTerm& term = solution.terms[from + t];
      const bool moves = term.observable[group.first] != 0 && !IsNarrowband(term);
      own.terms.push_back({moves ? &slopes[run][t] : nullptr, solution.channels[group.first].first[from + t],
                           ColumnsOf(term), static_cast<Index>(term.nonlinear_parameters.size()),
                           IsNarrowband(term)});
    }
    std::vector<MatrixXd> follows =
        predicts ? ProjectedDerivatives(
                       own, parallel_,
                       derivatives.middleRows(static_cast<Index>(run_channels_[group.first].channel->first),
                                              columns.rows() * static_cast<Index>(group.count)))
                 : AddChannels(own, parallel_, step);
    for (std::size_t k = 0; k < group.count; ++k)
      solution.channels[group.first + k].follows_nonlinear_parameters = std::move(follows[k]);
  }
  if (predicts) return StepOfPredicted(solution, from, nonlinear_parameters, std::move(derivatives));
  return step;
}

VibrationSolution VibrationSolver::Refine(VibrationSolution solution, int rounds, std::size_t from) const {
  const std::vector<VibrationNonlinearParameter> nonlinear_parameters =
      BoundsFrom(samples_, solution.terms, from);
  if (nonlinear_parameters.empty()) return solution;
  return Descend(
      std::move(solution), rounds,
      [&](VibrationSolution& at) { return Step(at, from, nonlinear_parameters); },
      [&](const VibrationSolution& at, const SharedStep& step, double damping) {
        std::vector<VibrationTerm> terms = at.terms;
        SetNonlinearParametersFrom(terms, from,
                                   MovedNonlinearParameters(NonlinearParametersFrom(terms, from),
                                                            nonlinear_parameters, step, damping));
        return Solve(std::move(terms), &at);
      });
}

MatrixXd VibrationSolver::NonlinearParameterCovariance(VibrationSolution& solution) const {
  const std::vector<VibrationNonlinearParameter> nonlinear_parameters =
      BoundsFrom(samples_, solution.terms, 0);
  if (nonlinear_parameters.empty()) return {};
  return solution.variance() * PseudoInverse(Step(solution, 0, nonlinear_parameters).normal);
}

}  // namespace strainwave::analysis::diagnosis
