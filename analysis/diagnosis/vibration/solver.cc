// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/diagnosis/vibration/narrowband.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kLongestMissing = 8;

std::vector<double> ShapesFrom(const std::vector<VibrationTerm>& terms, std::size_t from) {
  std::vector<double> shapes;
  for (std::size_t t = from; t < terms.size(); ++t)
    shapes.insert(shapes.end(), terms[t].shapes.begin(), terms[t].shapes.end());
  return shapes;
}

void SetShapesFrom(std::vector<VibrationTerm>& terms, std::size_t from, std::span<const double> shapes) {
  std::size_t s = 0;
  for (std::size_t t = from; t < terms.size(); ++t) {
    for (double& shape : terms[t].shapes) shape = shapes[s++];
  }
}

std::vector<VibrationShape> BoundsFrom(const VibrationSamples& samples,
                                       const std::vector<VibrationTerm>& terms, std::size_t from) {
  std::vector<VibrationShape> bounds;
  for (std::size_t t = from; t < terms.size(); ++t) {
    const std::vector<VibrationShape> own = ShapesOf(samples, terms[t]);
    bounds.insert(bounds.end(), own.begin(), own.end());
  }
  return bounds;
}

bool SameColumns(const VibrationTerm& a, const VibrationTerm& b) {
  const auto same_line = [](const LinePlace& x, const LinePlace& y) {
    return x.harmonic == y.harmonic && x.offset == y.offset;
  };
  return a.form == b.form && a.shapes == b.shapes &&
         std::equal(a.lines.begin(), a.lines.end(), b.lines.begin(), b.lines.end(), same_line);
}

Narrowband NarrowbandOf(const VibrationTerm& term, std::size_t channel) {
  return {term.shapes[0], term.shapes[1], term.shapes[2 + channel]};
}

}  // namespace

double VibrationSolution::bic() const {
  return weight_sum * std::log(std::max(square_sum, 1e-300) / weight_sum) +
         free_parameters * std::log(weight_sum);
}

std::vector<double> MovedShapes(std::vector<double> shapes, std::span<const VibrationShape> bounds,
                                const SharedStep& step, double damping) {
  constexpr double kMostSteps = 20.0;
  MatrixXd damped = step.normal;
  damped.diagonal() *= 1.0 + damping;
  const VectorXd change = PseudoInverse(damped) * step.gradient;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    const double most = kMostSteps * bounds[s].step;
    shapes[s] = std::clamp(shapes[s] + std::clamp(change(static_cast<Index>(s)), -most, most), bounds[s].low,
                           bounds[s].high);
  }
  return shapes;
}

VibrationSolver::VibrationSolver(const VibrationSamples& samples, std::span<const double> weights)
    : samples_(samples), weights_(weights.begin(), weights.end()) {
  for (std::size_t r = 0; r < samples_.runs.size(); ++r) {
    for (const VibrationStretch& channel : samples_.runs[r].channels) places_.push_back({r, &channel});
  }
  breaks_.assign(weights_.size(), 0);
  missing_.assign(weights_.size(), 0);
  for (const std::size_t first : samples_.stretches) breaks_[first] = 1;
  for (std::size_t i = 0; i < weights_.size();) {
    std::size_t end = i;
    while (end < weights_.size() && !(weights_[end] > 0.0)) ++end;
    if (end - i <= kLongestMissing)
      std::fill(missing_.begin() + static_cast<std::ptrdiff_t>(i),
                missing_.begin() + static_cast<std::ptrdiff_t>(end), 1);
    i = end + 1;
  }
}

void VibrationSolver::Filter(const VibrationSolution& solution, std::size_t channel,
                             Eigen::Ref<MatrixXd> columns) const {
  const VibrationRun& run = samples_.runs[places_[channel].run];
  const std::size_t first = places_[channel].channel->first;
  for (const VibrationTerm& term : solution.terms) {
    if (term.form != VibrationForm::kNarrowband || term.heard[channel] == 0) continue;
    ApplyFilter(FilterOf(NarrowbandOf(term, channel), run.period_s),
                std::span(breaks_).subspan(first, run.size()), std::span(missing_).subspan(first, run.size()),
                columns);
  }
}

MatrixXd VibrationSolver::Assemble(const VibrationSolution& solution, std::size_t channel) const {
  const Place& place = places_[channel];
  const VibrationRun& run = samples_.runs[place.run];
  Index width = run.nominal.cols();
  for (std::size_t t = 0; t < solution.terms.size(); ++t) {
    if (solution.terms[t].heard[channel] != 0) width += solution.columns[place.run][t]->cols();
  }
  // The response is the last column, so that it is filtered with the rest.
  MatrixXd all(static_cast<Index>(run.size()), width + 1);
  all.leftCols(run.nominal.cols()) = run.nominal;
  Index column = run.nominal.cols();
  for (std::size_t t = 0; t < solution.terms.size(); ++t) {
    if (solution.terms[t].heard[channel] == 0) continue;
    const MatrixXd& own = *solution.columns[place.run][t];
    all.middleCols(column, own.cols()) = own;
    column += own.cols();
  }
  all.col(width) = Eigen::Map<const VectorXd>(samples_.measured.data() + place.channel->first,
                                              static_cast<Index>(run.size()));
  Filter(solution, channel, all);
  return all;
}

VibrationSolution VibrationSolver::Solve(std::vector<VibrationTerm> terms,
                                         const VibrationSolution* previous) const {
  VibrationSolution solution;
  solution.terms = std::move(terms);
  solution.columns.resize(samples_.runs.size());
  for (std::size_t r = 0; r < samples_.runs.size(); ++r) {
    for (const VibrationTerm& term : solution.terms) {
      std::shared_ptr<const MatrixXd> found;
      for (std::size_t p = 0; previous != nullptr && p < previous->terms.size() && !found; ++p) {
        if (SameColumns(previous->terms[p], term)) found = previous->columns[r][p];
      }
      solution.columns[r].push_back(found ? found
                                          : std::make_shared<const MatrixXd>(FillTerm(samples_, r, term)));
    }
  }
  solution.weight_sum = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  for (const VibrationTerm& term : solution.terms) {
    const bool narrow = term.form == VibrationForm::kNarrowband;
    solution.free_parameters += narrow ? 2 : static_cast<int>(term.shapes.size());
    if (narrow)
      solution.free_parameters += static_cast<int>(
          std::count_if(term.heard.begin(), term.heard.end(), [](char h) { return h != 0; }));
  }
  for (std::size_t c = 0; c < places_.size(); ++c) {
    const MatrixXd all = Assemble(solution, c);
    const Index width = all.cols() - 1;
    VibrationSolution::Channel channel;
    channel.fit =
        FitChannel(all.leftCols(width), all.col(width),
                   Eigen::Map<const VectorXd>(weights_.data() + places_[c].channel->first, all.rows()));
    Index column = samples_.runs[places_[c].run].nominal.cols();
    for (std::size_t t = 0; t < solution.terms.size(); ++t) {
      const bool heard = solution.terms[t].heard[c] != 0;
      channel.first.push_back(heard ? column : -1);
      if (heard) column += solution.columns[places_[c].run][t]->cols();
    }
    solution.square_sum += channel.fit.square_sum;
    solution.free_parameters += static_cast<int>(width);
    solution.channels.push_back(std::move(channel));
  }
  return solution;
}

VectorXd VibrationSolver::Residual(const VibrationSolution& solution) const {
  VectorXd residual(static_cast<Index>(weights_.size()));
  for (std::size_t c = 0; c < places_.size(); ++c) {
    const VectorXd& own = solution.channels[c].fit.residual;
    residual.segment(static_cast<Index>(places_[c].channel->first), own.size()) = own;
  }
  return residual;
}

MatrixXd VibrationSolver::Derivatives(
    const VibrationSolution& solution, std::size_t channel, std::size_t from,
    const std::vector<VibrationShape>& shapes,
    const std::vector<std::vector<std::shared_ptr<const MatrixXd>>>& moved) const {
  const Place& place = places_[channel];
  const VibrationRun& run = samples_.runs[place.run];
  const auto n = static_cast<Index>(run.size());
  const VibrationSolution::Channel& fitted = solution.channels[channel];
  MatrixXd derivatives = MatrixXd::Zero(n, static_cast<Index>(shapes.size()));
  VectorXd unexplained;
  std::size_t s = 0;
  for (std::size_t t = from; t < solution.terms.size(); ++t) {
    const VibrationTerm& term = solution.terms[t];
    for (std::size_t k = 0; k < term.shapes.size(); ++k, ++s) {
      const auto column = static_cast<Index>(s);
      if (term.heard[channel] == 0) continue;
      if (term.form != VibrationForm::kNarrowband) {
        const MatrixXd& slope = *moved[place.run][s];
        derivatives.col(column) = slope * fitted.fit.coefficients.segment(fitted.first[t], slope.cols());
        Filter(solution, channel, derivatives.col(column));
        continue;
      }
      if (k >= 2 && k - 2 != channel) continue;
      if (unexplained.size() == 0) {
        // What the filters are applied to: the response less the model.
        unexplained = Eigen::Map<const VectorXd>(samples_.measured.data() + place.channel->first, n) -
                      run.nominal * fitted.fit.coefficients.head(run.nominal.cols());
        for (std::size_t other = 0; other < solution.terms.size(); ++other) {
          if (fitted.first[other] < 0) continue;
          const MatrixXd& own = *solution.columns[place.run][other];
          unexplained -= own * fitted.fit.coefficients.segment(fitted.first[other], own.cols());
        }
      }
      MatrixXd ends[2] = {unexplained, unexplained};
      for (int end = 0; end < 2; ++end) {
        VibrationSolution shifted;
        shifted.terms = solution.terms;
        shifted.terms[t].shapes[k] += (end == 0 ? -0.1 : 0.1) * shapes[s].step;
        Filter(shifted, channel, ends[end]);
      }
      derivatives.col(column) = -(ends[1] - ends[0]) / (0.2 * shapes[s].step);
    }
  }
  return derivatives;
}

SharedStep VibrationSolver::Step(VibrationSolution& solution, std::size_t from,
                                 const std::vector<VibrationShape>& shapes) const {
  // Slopes of the columns by each shape, once a run: the channels share them.
  std::vector<std::vector<std::shared_ptr<const MatrixXd>>> moved(samples_.runs.size());
  for (std::size_t r = 0; r < samples_.runs.size(); ++r) {
    std::size_t s = 0;
    for (std::size_t t = from; t < solution.terms.size(); ++t) {
      const VibrationTerm& term = solution.terms[t];
      for (std::size_t k = 0; k < term.shapes.size(); ++k, ++s) {
        moved[r].push_back(nullptr);
        if (term.form == VibrationForm::kNarrowband) continue;
        moved[r].back() = std::make_shared<const MatrixXd>(
            FillSlope(samples_, r, term, *solution.columns[r][t], k, 0.1 * shapes[s].step));
      }
    }
  }
  SharedStep step(static_cast<Index>(shapes.size()));
  for (std::size_t c = 0; c < places_.size(); ++c) {
    const MatrixXd all = Assemble(solution, c);
    solution.channels[c].follows_shapes = step.Add(
        all.leftCols(all.cols() - 1), Derivatives(solution, c, from, shapes, moved), solution.channels[c].fit,
        Eigen::Map<const VectorXd>(weights_.data() + places_[c].channel->first, all.rows()));
  }
  return step;
}

VibrationSolution VibrationSolver::Refine(VibrationSolution solution, int rounds, std::size_t from) const {
  const std::vector<VibrationShape> shapes = BoundsFrom(samples_, solution.terms, from);
  if (shapes.empty()) return solution;
  return Descend(
      std::move(solution), rounds, [&](VibrationSolution& at) { return Step(at, from, shapes); },
      [&](const VibrationSolution& at, const SharedStep& step, double damping) {
        std::vector<VibrationTerm> terms = at.terms;
        SetShapesFrom(terms, from, MovedShapes(ShapesFrom(terms, from), shapes, step, damping));
        return Solve(std::move(terms), &at);
      });
}

MatrixXd VibrationSolver::ShapeCovariance(VibrationSolution& solution) const {
  const std::vector<VibrationShape> shapes = BoundsFrom(samples_, solution.terms, 0);
  return solution.variance() * PseudoInverse(Step(solution, 0, shapes).normal);
}

}  // namespace strainwave::analysis::diagnosis
