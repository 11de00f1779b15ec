// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/motion/terms.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

// A curve's ordinates are taken for normal about zero, with this part of the noise's variance for precision
// (a standard deviation of three times the noise's): where held-out rows are the only ones at a speed or a
// position, a curve that has not seen them stays near zero there.
constexpr double kCurveRidge = 0.1;

// Uniform cubic B-spline of `count` functions over [low, high].
double Spline(double value, double low, double high, std::size_t count, std::size_t which) {
  const double knots = static_cast<double>(count - 3);
  const double u =
      std::clamp((value - low) / (high - low), 0.0, 1.0) * knots - static_cast<double>(which) + 1.0;
  const double x = std::abs(u);
  if (x >= 2.0) return 0.0;
  return x < 1.0 ? 2.0 / 3.0 - x * x + 0.5 * x * x * x : (2.0 - x) * (2.0 - x) * (2.0 - x) / 6.0;
}

// A smooth function of a quantity of the points, times another one: what the nominal terms do not make up of
// it.
void AddSmooth(const SharedGrid& grid, const MotionUnits& units, std::string name, std::string sentence,
               const std::vector<double>& of, const std::function<double(std::size_t)>& times,
               std::size_t count, SeparableModel& model) {
  std::vector<double> sorted = of;
  std::sort(sorted.begin(), sorted.end());
  const double low = sorted[sorted.size() / 200];
  const double high = sorted[sorted.size() - 1 - sorted.size() / 200];
  if (!(high > low)) return;
  double square_sum = 0.0;
  for (std::size_t i = 0; i < of.size(); ++i) square_sum += times(i) * times(i);
  const double scale = 1.0 / std::sqrt(std::max(square_sum / static_cast<double>(of.size()), 1e-300));
  Eigen::MatrixXd columns(grid->nominal.rows(), static_cast<Index>(count));
  std::vector<double> points(of.size());
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i] = scale * times(i) * Spline(of[i], low, high, count, k);
    columns.col(static_cast<Index>(k)) = grid->BesideNominal(grid->Project(points));
  }
  const SingularParts parts = SquareSingular(columns.transpose() * columns);
  Index kept = 0;
  while (kept < columns.cols() && parts.values(kept) > kCurveRidge) ++kept;
  if (kept == 0) return;
  std::vector<NonlinearParameterDescription> numbers;
  for (Index k = 0; k < kept; ++k)
    numbers.push_back({fmt::format("{}{}_{}", kCurvePart, k + 1, units.torque()), units.torque(), 1.0});
  SeparableTerm term = FixedTerm(columns * parts.vectors.leftCols(kept));
  term.ridge = kCurveRidge;
  DescribeEach(term, std::move(numbers));
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = std::move(name),
                         .sentence = std::move(sentence),
                         .degrees_of_freedom = static_cast<int>(kept),
                         .location_parameters = static_cast<int>(kept) - 1,
                         .named = false});
}

void AddSmoothFunctions(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const std::string torque = units.linear ? "force" : "torque";
  const auto one = [](std::size_t) { return 1.0; };
  std::vector<double> speed(grid->velocity.size());
  for (std::size_t i = 0; i < speed.size(); ++i) speed[i] = std::abs(grid->velocity[i]);
  AddSmooth(
      grid, units, "function of speed, against the motion",
      "a friction that depends on speed in a way of its own", speed,
      [grid](std::size_t i) { return grid->direction[i]; }, 7, model);
  AddSmooth(
      grid, units, "detailed function of speed, against the motion",
      "a friction that depends on speed in a way of its own", speed,
      [grid](std::size_t i) { return grid->direction[i]; }, 14, model);
  AddSmooth(grid, units, "function of speed, one way",
            "a " + torque + " that depends on speed, but not on its direction", speed, one, 7, model);
  AddSmooth(grid, units, "function of position", "a " + torque + " that depends on position", grid->position,
            one, 10, model);
  AddSmooth(
      grid, units, "friction over position", "friction that depends on position", grid->position,
      [grid](std::size_t i) { return grid->direction[i]; }, 6, model);
  AddSmooth(
      grid, units, "inertia over position", "an inertia that depends on position", grid->position,
      [grid](std::size_t i) { return grid->passed_acceleration[i]; }, 6, model);
  AddSmooth(grid, units, "function of time", "a " + torque + " that changes slowly over the record",
            grid->time_s, one, 8, model);
  AddSmooth(grid, units, "function of acceleration",
            "a " + torque + " that does not grow in proportion to acceleration", grid->passed_acceleration,
            one, 7, model);
}

void AddTimeLine(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  std::vector<double> time_s;
  for (std::size_t row = 0; row < grid->rows(); ++row) time_s.push_back(grid->RowTime_s(row));
  const auto [first, last] = std::minmax_element(time_s.begin(), time_s.end());
  const double duration_s = *last - *first;
  const double low = kTwoPi * 3.0 / duration_s;
  const double high = 1.2 * grid->cutoff_rad_per_s();
  if (!(high > 2.0 * low)) return;
  SeparableTerm term = PointTerm(
      grid, 2,
      [grid](std::span<const double> nonlinear_parameters, std::size_t column, std::span<double> points) {
        const double rate = kTwoPi * nonlinear_parameters[0];
        for (std::size_t i = 0; i < points.size(); ++i) {
          points[i] = column == 0 ? std::cos(rate * grid->time_s[i]) : std::sin(rate * grid->time_s[i]);
        }
      });
  term.nonlinear_parameters = {{low / kTwoPi, high / kTwoPi, 0.2 / duration_s}};
  term.starts = [time_s, low, high](const WeightedResidual& residual) {
    std::vector<std::vector<double>> starts;
    for (const LinePeak& peak : FindLines(time_s, residual.values, residual.weights, low, high, 2)) {
      starts.push_back({peak.order / kTwoPi});
    }
    return starts;
  };
  term.log_search_locations = [low, high](std::span<const double> nonlinear_parameters) {
    return LogSearchLocationsOfLine(kTwoPi * nonlinear_parameters[0], low, high);
  };
  DescribeAsHarmonic(term, "amplitude_" + units.torque(), units.torque(), 1.0, {{"frequency_Hz", "Hz", 1.0}});
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = "line over time",
                         .sentence = "something that repeats in time, whatever the axis does",
                         .parameters = {{"amplitude_" + units.torque(), units.torque(), 0.0,
                                         std::numeric_limits<double>::max(), true}},
                         .degrees_of_freedom = 3,
                         .trials_factor = IndependentOrders(time_s, low, high),
                         .named = false});
}

void AddPositionWindow(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  std::vector<double> position;
  for (const std::size_t point : grid->point_of_row) position.push_back(grid->position[point]);
  const auto [first, last] = std::minmax_element(position.begin(), position.end());
  const double range = *last - *first;
  const double narrowest = std::max(range / 300.0, 6.0 * grid->position_noise);
  const double widest = 0.2 * range;
  if (!(widest > 2.0 * narrowest)) return;
  SeparableTerm term = PointTerm(
      grid, 1, [grid](std::span<const double> nonlinear_parameters, std::size_t, std::span<double> points) {
        const double deviation = std::exp(nonlinear_parameters[1]) / 2.355;
        for (std::size_t i = 0; i < points.size(); ++i) {
          const double u = (grid->position[i] - nonlinear_parameters[0]) / deviation;
          points[i] = std::abs(u) < 8.0 ? std::exp(-0.5 * u * u) : 0.0;
        }
      });
  term.nonlinear_parameters = {{*first, *last, narrowest},
                               {std::log(0.5 * narrowest), std::log(2.0 * widest), 0.2}};
  term.starts = [position, narrowest, widest](const WeightedResidual& residual) {
    std::vector<std::vector<double>> starts;
    for (const WindowPeak& peak :
         FindWindows(position, residual.values, residual.weights, narrowest, widest, 2)) {
      starts.push_back({peak.centre, std::log(peak.width)});
    }
    return starts;
  };
  term.log_search_locations = [narrowest, widest](std::span<const double> nonlinear_parameters) {
    return LogSearchLocationsOfWidth(std::exp(nonlinear_parameters[1]), narrowest, widest);
  };
  const std::string unit = units.position();
  const std::string height = "height_" + units.torque();
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    const auto error = [&](Index i) { return StandardErrorOf(covariance(i, i)); };
    const double width = std::exp(numbers[2]);
    return std::vector<ParameterValue>{{height, units.torque(), numbers[0], error(0)},
                                       {"centre_" + unit, unit, numbers[1], error(1)},
                                       {"width_" + unit, unit, width, width * error(2)}};
  };
  term.restore = [](std::span<const double> values) {
    return std::vector<double>{values[0], values[1], std::log(std::max(values[2], 1e-300))};
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = "window over position",
                         .sentence = "something that happens at one place of the axis",
                         .parameters = {{height, units.torque(), -std::numeric_limits<double>::max(),
                                         std::numeric_limits<double>::max(), true}},
                         .degrees_of_freedom = 3,
                         .trials_factor = 2.0 * range / narrowest,
                         .local = true,
                         .named = false});
}

// Way since the last reversal, at each point.
std::vector<double> WaySinceReversal(const MotionGrid& grid) {
  std::vector<double> way(grid.position.size());
  const double certain = 2.0 * grid.velocity_noise;
  for (const MotionGrid::Segment& segment : grid.segments) {
    double turned = grid.position[segment.first];
    double extreme = turned;
    int direction = 0;
    for (std::size_t i = segment.first; i < segment.first + segment.count; ++i) {
      const int now = (grid.velocity[i] > certain) - (grid.velocity[i] < -certain);
      if (direction != 0) {
        extreme = direction > 0 ? std::max(extreme, grid.position[i]) : std::min(extreme, grid.position[i]);
      }
      if (now != 0 && now != direction) {
        turned = direction == 0 ? grid.position[i] - static_cast<double>(now) * 1e9 : extreme;
        extreme = grid.position[i];
        direction = now;
      }
      way[i] = std::abs(grid.position[i] - turned);
    }
  }
  return way;
}

void AddAfterReversal(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const auto [first, last] = std::minmax_element(grid->position.begin(), grid->position.end());
  // Shorter than the way over which smoothing blurs a reversal it is the reversal's own shape.
  const double acceleration = QuantileOfMagnitude(grid->passed_acceleration, 0.68);
  const double blurred = 2.0 * acceleration * std::pow(std::max(grid->sigma_s, grid->path_sigma_s), 2);
  const double low = std::max({3.0 * grid->position_noise, 1e-6 * (*last - *first), blurred});
  const double high = 0.1 * (*last - *first);
  if (!(high > 4.0 * low)) return;
  const std::vector<double> way = WaySinceReversal(*grid);
  SeparableTerm term = PointTerm(
      grid, 1,
      [grid, way](std::span<const double> nonlinear_parameters, std::size_t, std::span<double> points) {
        const double length = std::exp(nonlinear_parameters[0]);
        for (std::size_t i = 0; i < points.size(); ++i) {
          points[i] = way[i] < 30.0 * length ? grid->direction[i] * std::exp(-way[i] / length) : 0.0;
        }
      });
  term.nonlinear_parameters = {{std::log(low), std::log(high), 0.3}};
  term.starts = [grid, term, low, high](const WeightedResidual& residual) {
    std::vector<std::vector<double>> candidates;
    for (const double length : GeometricSteps(1.5 * low, 0.7 * high, 8))
      candidates.push_back({std::log(length)});
    return BestStarts(*grid, term, candidates, residual, 2);
  };
  const std::string amount = "after_reversal_" + units.torque();
  const std::string length = "way_" + units.position();
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    const double at = std::exp(numbers[1]);
    return std::vector<ParameterValue>{
        {amount, units.torque(), numbers[0], StandardErrorOf(covariance(0, 0))},
        {length, units.position(), at, at * StandardErrorOf(covariance(1, 1))}};
  };
  term.restore = [](std::span<const double> values) {
    return std::vector<double>{values[0], std::log(std::max(values[1], 1e-300))};
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back(
      {.name = "way since the last reversal",
       .sentence = "friction that builds up, or falls, over a short way after each reversal (presliding)",
       .effect = "E12",
       .degrees_of_freedom = 2,
       .trials_factor = 4.0,
       .named = false});
}

}  // namespace

void AddMotionNuisanceTerms(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  AddTimeLine(grid, units, model);
  AddPositionWindow(grid, units, model);
  AddAfterReversal(grid, units, model);
  AddSmoothFunctions(grid, units, model);
}

}  // namespace strainwave::analysis::diagnosis
