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
double FoldedPower(const VibrationRemainder& remainder, double order) {
  const double variance = remainder.base().variance();
  double sum = 0.0;
  for (const VibrationRun& run : remainder.samples().runs) {
    std::vector<std::complex<double>> line(run.size());
    for (std::size_t i = 0; i < run.size(); ++i) line[i] = std::polar(1.0, order * run.angle_rad[i]);
    for (const VibrationStretch& channel : run.channels) {
      std::complex<double> product;
      for (std::size_t i = 0; i < run.size(); ++i) {
        if (remainder.solver().weights()[channel.first + i] > 0.0)
          product += remainder.residual()[channel.first + i] * line[i];
      }
      sum += std::norm(product) / (variance * static_cast<double>(run.size()));
    }
  }
  return sum;
}

double ExcessAt(const VibrationRemainder& remainder, double order) {
  return ExcessOf(PowerAt(remainder, order), static_cast<double>(remainder.over_turns().channels()));
}

}  // namespace

VibrationTerm LinesTerm(const VibrationRemainder& remainder, std::size_t index) {
  VibrationTerm term;
  term.cause = index;
  term.form = VibrationForm::kLines;
  term.heard.assign(remainder.samples().channels(), 1);
  return term;
}

double PowerAt(const VibrationRemainder& remainder, double order) {
  const bool folded = order > 0.98 * remainder.samples().highest_order();
  return folded ? FoldedPower(remainder, order) : remainder.over_turns().At(order);
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

std::optional<TermFit> FitPayingLines(const VibrationRemainder& remainder, VibrationTerm term,
                                      const std::vector<LinePlace>& places, std::size_t fewest,
                                      const std::function<bool(std::span<const LinePlace>)>& may_be) {
  const double base = term.shapes.empty() ? 1.0 : term.shapes[0];
  const double threshold = 0.8 * std::log(remainder.base().weight_sum);
  std::vector<std::pair<double, LinePlace>> found;
  for (const LinePlace& place : places) {
    const double order = place.harmonic * base + place.offset;
    const double excess = ExcessAt(remainder, order);
    const bool taken = std::any_of(found.begin(), found.end(), [&](const auto& other) {
      return std::abs(other.second.harmonic * base + other.second.offset - order) <
             0.3 * remainder.over_turns().cell();
    });
    if (excess > threshold && !taken) found.emplace_back(excess, place);
  }
  if (found.size() < fewest) return std::nullopt;
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  found.resize(std::min(found.size(), kMostLines));
  for (const auto& [excess, place] : found) term.lines.push_back(place);
  if (!may_be(term.lines)) return std::nullopt;
  TermFit solution = remainder.With(term, term.shapes.empty() ? 0 : 5);
  while (solution.term.lines.size() >= fewest) {
    const std::vector<double> gains = LineGains(solution);
    const auto worst = std::min_element(gains.begin(), gains.end());
    if (*worst > 0.0) return solution;
    VibrationTerm fewer = solution.term;
    fewer.lines.erase(fewer.lines.begin() + (worst - gains.begin()));
    if (fewer.lines.size() < fewest || !may_be(fewer.lines)) break;
    solution = remainder.With(std::move(fewer), 0);
  }
  return std::nullopt;
}

double BestScale(const VibrationRemainder& remainder, const std::vector<double>& orders) {
  const double highest = *std::max_element(orders.begin(), orders.end());
  const double step = 0.25 * remainder.over_turns().cell() / highest;
  const double range = std::min(kScaleRange * remainder.samples().order_uncertainty, kMostScales * step);
  double best = 1.0;
  double most = -1.0;
  for (double change = 0.0; change <= range; change += step) {
    for (const double scale : {1.0 - change, 1.0 + change}) {
      double sum = 0.0;
      for (const double order : orders) sum += ExcessAt(remainder, scale * order);
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
