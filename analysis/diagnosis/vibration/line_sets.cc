// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/line_sets.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "analysis/diagnosis/vibration/bearing_orders.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kMostScales = 500.0;  // of known orders, to either side

// Power of a line beyond half the sampling rate: no spectrum has it, but its samples are there, folded.
double FoldedPower(const VibrationResidual& residual, double order) {
  const double variance = residual.base().variance();
  double sum = 0.0;
  for (const VibrationRun& run : residual.samples().runs) {
    std::vector<std::complex<double>> line(run.size());
    for (std::size_t i = 0; i < run.size(); ++i) line[i] = std::polar(1.0, order * run.angle_rad[i]);
    for (const VibrationSegment& channel : run.channels) {
      std::complex<double> product;
      for (std::size_t i = 0; i < run.size(); ++i) {
        if (residual.solver().weights()[channel.first + i] > 0.0)
          product += residual.residual()[channel.first + i] * line[i];
      }
      sum += std::norm(product) / (variance * static_cast<double>(run.size()));
    }
  }
  return sum;
}

double ExcessAt(const VibrationResidual& residual, double order) {
  return ExcessOf(PowerAt(residual, order), static_cast<double>(residual.over_turns().channels()));
}

}  // namespace

VibrationTerm LinesTerm(const VibrationResidual& residual, std::size_t index) {
  VibrationTerm term;
  term.cause = index;
  term.form = VibrationForm::kLines;
  term.observable.assign(residual.samples().channels(), 1);
  return term;
}

double PowerAt(const VibrationResidual& residual, double order) {
  const bool folded = order > 0.98 * residual.samples().highest_order();
  return folded ? FoldedPower(residual, order) : residual.over_turns().At(order);
}

std::vector<double> LineGains(const TermFit& fit) {
  std::vector<double> gains(fit.term.lines.size(), 0.0);
  for (const TermFit::Channel& channel : fit.channels) {
    if (channel.coefficients.size() == 0) continue;
    for (std::size_t l = 0; l < gains.size(); ++l) {
      const auto at = static_cast<Eigen::Index>(2 * l);
      const Eigen::Vector2d own = channel.coefficients.segment(at, 2);
      const Eigen::MatrixXd block = channel.inverse.block(at, at, 2, 2);
      gains[l] += own.dot(PseudoInverse(block) * own) / fit.variance() - 2.0 * std::log(fit.weight_sum);
    }
  }
  return gains;
}

std::optional<TermFit> FitPayingLines(const VibrationResidual& residual, VibrationTerm term,
                                      const std::vector<LineOrder>& candidates, std::size_t fewest,
                                      const std::function<bool(std::span<const LineOrder>)>& may_be) {
  const double base = term.nonlinear_parameters.empty() ? 1.0 : term.nonlinear_parameters[0];
  const double threshold = 0.8 * std::log(residual.base().weight_sum);
  std::vector<std::pair<double, LineOrder>> found;
  for (const LineOrder& line : candidates) {
    const double order = line.harmonic * base + line.offset;
    const double excess = ExcessAt(residual, order);
    const bool taken = std::any_of(found.begin(), found.end(), [&](const auto& other) {
      return std::abs(other.second.harmonic * base + other.second.offset - order) <
             0.3 * residual.over_turns().cell();
    });
    if (excess > threshold && !taken) found.emplace_back(excess, line);
  }
  if (found.size() < fewest) return std::nullopt;
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  found.resize(std::min(found.size(), kMostLines));
  for (const auto& [excess, line] : found) term.lines.push_back(line);
  if (!may_be(term.lines)) return std::nullopt;
  TermFit solution = residual.With(term, term.nonlinear_parameters.empty() ? 0 : 5);
  while (solution.term.lines.size() >= fewest) {
    const std::vector<double> gains = LineGains(solution);
    const auto worst = std::min_element(gains.begin(), gains.end());
    if (*worst > 0.0) return solution;
    VibrationTerm fewer = solution.term;
    fewer.lines.erase(fewer.lines.begin() + (worst - gains.begin()));
    if (fewer.lines.size() < fewest || !may_be(fewer.lines)) break;
    solution = residual.With(std::move(fewer), 0);
  }
  return std::nullopt;
}

double BestScale(const VibrationResidual& residual, const std::vector<double>& orders) {
  const double highest = *std::max_element(orders.begin(), orders.end());
  const double step = 0.25 * residual.over_turns().cell() / highest;
  const double range = std::min(kScaleRange * residual.samples().order_uncertainty, kMostScales * step);
  double best = 1.0;
  double most = -1.0;
  for (double change = 0.0; change <= range; change += step) {
    for (const double scale : {1.0 - change, 1.0 + change}) {
      double sum = 0.0;
      for (const double order : orders) sum += ExcessAt(residual, scale * order);
      // A scale of its own has to pay for itself.
      if (change > 0.0) sum -= 8.0;
      if (sum > most) {
        most = sum;
        best = scale;
      }
    }
  }
  return best;
}

bool ScaleIsOpen(const VibrationSamples& samples, double order) {
  return kScaleRange * samples.order_uncertainty * order * samples.shortest_turns() > 0.25;
}

}  // namespace strainwave::analysis::diagnosis
