// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/delay.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/motion/usual_effects.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr double kFar = 2.0;       // times the delay
constexpr double kClearly = 12.0;  // in −2 log-likelihood
// Of a sampling step. Clean axes of dahl_dither_axis (tests/blind/generators) had 0.09 to 0.13 (seed 5302).
constexpr double kWithinStep = 0.15;

// The nominal terms of motion a time later.
Eigen::MatrixXd MotionLater(const MotionGrid& grid, double shift_s) {
  Eigen::MatrixXd later(grid.nominal.rows(), 3);
  later.col(0) = grid.ProjectPassed(grid.Later(grid.passed_acceleration, shift_s));
  later.col(1) = grid.ProjectPassed(grid.Later(grid.velocity, shift_s));
  later.col(2) = grid.Project(DirectionLater(grid, shift_s));
  return later;
}

double LongestDelay_s(const MotionGrid& grid) {
  double duration_s = 0.0;
  for (const MotionGrid::Segment& segment : grid.segments) {
    duration_s += segment.step_s * static_cast<double>(segment.count);
  }
  return std::min(std::max(0.06, 8.0 * grid.row_spacing_s), 0.02 * duration_s);
}

// Orthonormal columns, weighted, of what may be in the record beside the nominal terms of motion.
Eigen::MatrixXd BesideMotion(const MotionGrid& grid) {
  const Eigen::MatrixXd usual = UsualEffectsAndLines(grid, StrongestOrders(grid));
  const Index records = grid.nominal.cols() - 3;
  Eigen::MatrixXd beside(grid.nominal.rows(), records + usual.cols());
  beside << grid.nominal.rightCols(records), usual;
  return OrthonormalBasis(grid.Weighted(beside));
}

std::string SentenceFor(double delay_s, const std::string& torque) {
  if (delay_s > 0.0)
    return "the " + torque +
           " acts later than it is recorded: a slow current loop, a bus cycle, or two clocks";
  if (delay_s < 0.0)
    return "the " + torque + " is recorded later than it acts: a filter of its signal, or two clocks";
  return torque + " and motion are not recorded for the same time: a bus cycle, or two clocks";
}

}  // namespace

DelayEstimate EstimateDelay(const MotionGrid& grid) {
  const Eigen::Map<const Eigen::VectorXd> measured(grid.measured.data(), grid.nominal.rows());
  const Eigen::MatrixXd basis = BesideMotion(grid);
  const Eigen::VectorXd weighted = grid.Weighted(measured);
  const Eigen::VectorXd rest = weighted - basis * (basis.transpose() * weighted);
  const auto left = [&](double delay_s) {
    Eigen::MatrixXd later = grid.Weighted(MotionLater(grid, delay_s));
    later -= basis * (basis.transpose() * later);
    return (rest - later * LeastSquares(later, rest)).squaredNorm();
  };
  constexpr int kSteps = 32;
  const double without = left(0.0);
  double best_s = 0.0;
  double least = without;
  const double step_s = LongestDelay_s(grid) / kSteps;
  for (int k = -kSteps; k <= kSteps; ++k) {
    const double value = left(k * step_s);
    if (value < least) least = value, best_s = k * step_s;
  }
  for (double half_s = 0.5 * step_s; half_s > 0.01 * step_s; half_s *= 0.5) {
    for (const double delay_s : {best_s - half_s, best_s + half_s}) {
      const double value = left(delay_s);
      if (value < least) least = value, best_s = delay_s;
    }
  }
  const double drop = static_cast<double>(grid.rows()) * std::log(without / least);
  return drop < kClearly ? DelayEstimate{0.0, without} : DelayEstimate{best_s, least};
}

void AddDelayCause(const SharedGrid& grid, double delay_s, double sampling_step_s, const MotionUnits& units,
                   SeparableModel& model) {
  const Eigen::Map<const Eigen::VectorXd> measured(grid->measured.data(), grid->nominal.rows());
  // Where the nominal model fits best when it is moved: there the term is linearised.
  const double about_s = std::copysign(std::max(std::abs(delay_s), 0.1 * grid->row_spacing_s), delay_s);
  // With all that may be there: a drag is moved as well, and what stands in for it is not moved like it.
  const std::vector<double> orders = StrongestOrders(*grid);
  const auto moved = [&](const Eigen::MatrixXd& nominal, double shift_s) {
    const Eigen::MatrixXd usual = UsualEffectsAndLines(*grid, orders, shift_s);
    Eigen::MatrixXd all(nominal.rows(), nominal.cols() + usual.cols());
    all << nominal, usual;
    return all;
  };
  Eigen::MatrixXd nominal_later = grid->nominal;
  nominal_later.leftCols(3) = MotionLater(*grid, about_s);
  const Eigen::MatrixXd later = moved(nominal_later, about_s);
  const Eigen::VectorXd numbers = LeastSquares(grid->Weighted(later), grid->Weighted(measured));
  const Eigen::VectorXd shift = (later - moved(grid->nominal, 0.0)) * numbers;
  SeparableTerm term = FixedTerm(shift / about_s);
  // Each reversal of a resampled torque is off by a part of a step of its own, which no residual's noise
  // tells: an error of the delay as far as it is known by what friction does there.
  const Eigen::VectorXd own = grid->BesideNominal(shift);
  const double by_friction =
      own.dot((later.col(2) - grid->nominal.col(2)) * numbers(2)) / std::max(own.squaredNorm(), 1e-300);
  const double timing_s = std::abs(by_friction) * grid->reversal_error_s /
                          std::sqrt(std::max(1.0, static_cast<double>(grid->Reversals())));
  term.describe = [timing_s](std::span<const double> fitted, const Eigen::MatrixXd& covariance) {
    return std::vector<ParameterValue>{
        {"delay_s", "s", fitted[0], std::hypot(StandardErrorOf(covariance(0, 0)), timing_s)}};
  };
  term.restore = [](std::span<const double> values) { return std::vector<double>{values[0]}; };
  model.causes.push_back(term);
  const double open_s = kWithinStep * sampling_step_s;
  // Far from where it was linearised the term is not a delay.
  const double most_s = std::max(std::abs(delay_s) * kFar, grid->row_spacing_s);
  const double least_s = delay_s == 0.0 ? -most_s : std::abs(delay_s) / kFar;
  const bool late = delay_s >= 0.0;
  model.rules.push_back(
      {.name = "time_delay",
       .what_to_do = "check filter and time stamps of the torque channel, or shift it by the delay named",
       .sentence = SentenceFor(delay_s, units.linear ? "force" : "torque"),
       .where = Where::kBench,
       .effect = "E20",
       .parameters = {{"delay_s", "s", late ? least_s : -most_s, late ? most_s : -least_s, true, open_s}},
       .trials_factor = 6.0});
  model.causes.push_back(std::move(term));
  model.rules.push_back(
      {.name = "instants of the samples",
       .what_to_do = "check filter and time stamps of the torque channel, or shift it by the delay named",
       .sentence = "the torque is recorded later than it acts, by less than 0.15 sampling steps",
       .parameters = {{"delay_s", "s", -open_s, 0.0, true}},
       .trials_factor = 6.0,
       .named = false,
       .stated_number = true});
}

}  // namespace strainwave::analysis::diagnosis
