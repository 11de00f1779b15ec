// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/motion/terms.h"

namespace strainwave::analysis::diagnosis {
namespace {

// At 1, and with a friction on the way that is larger than the load, direction · |load + friction| is the
// load itself: gravity would have a second name.
constexpr double kMostCoefficient = 0.95;

// Torque that passes the axis and torque that friction takes, at the points, as a fit with weight has them.
struct Passing {
  std::vector<double> load;
  std::vector<double> friction;
  double largest{};  // of |load|
  double offset{};
};

Passing PassingTorque(const MotionGrid& grid) {
  const auto nominal = grid.nominal.cols();
  std::vector<double> cosine(grid.position.size(), 0.0);
  std::vector<double> sine(grid.position.size(), 0.0);
  for (std::size_t i = 0; i < cosine.size() && !grid.linear; ++i) {
    cosine[i] = std::cos(grid.position[i]);
    sine[i] = std::sin(grid.position[i]);
  }
  Eigen::MatrixXd design(grid.nominal.rows(), nominal + 3);
  design.leftCols(nominal) = grid.nominal;
  design.col(nominal) = grid.Project(cosine);
  design.col(nominal + 1) = grid.Project(sine);
  design.col(nominal + 2).setZero();
  const Eigen::Map<const Eigen::VectorXd> measured(grid.measured.data(), grid.nominal.rows());
  Passing passing;
  passing.load.resize(grid.position.size());
  passing.friction.resize(grid.position.size());
  // A friction that follows the load makes the inertia look larger: once more with the term itself.
  std::vector<double> points(grid.position.size());
  for (int round = 0; round < 3; ++round) {
    const Eigen::VectorXd numbers = ShortestLeastSquares(design, measured);
    passing.offset = numbers(3);
    for (std::size_t i = 0; i < points.size(); ++i) {
      passing.load[i] = numbers(0) * grid.passed_acceleration[i] + numbers(nominal) * cosine[i] +
                        numbers(nominal + 1) * sine[i];
      passing.friction[i] = numbers(1) * grid.velocity[i] + numbers(2) * grid.direction[i];
      points[i] = grid.direction[i] * std::abs(passing.load[i]);
    }
    design.col(nominal + 2) = grid.Project(points);
  }
  passing.largest = QuantileOfMagnitude(passing.load, 0.98);
  return passing;
}

}  // namespace

void AddLoadCause(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  Passing passing = PassingTorque(*grid);
  std::vector<double> points(passing.load.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = grid->direction[i] * std::abs(passing.load[i]);
  if (!(passing.largest > 0.0) || ShareBesideNominal(*grid, grid->Project(points)) < 0.01) {
    model.warnings.push_back(
        fmt::format("no verdict on load_dependent_friction: the {} is nearly the same all the time (expected "
                    "several loads)",
                    units.linear ? "force" : "torque"));
    return;
  }
  // What counts as transmitted differs: a constant load or none of the offset, with the friction on the way
  // or without. Both are nonlinear parameters.
  SeparableTerm term = PointTerm(
      grid, 1,
      [grid, passing](std::span<const double> nonlinear_parameters, std::size_t, std::span<double> at) {
        for (std::size_t i = 0; i < at.size(); ++i) {
          at[i] = grid->direction[i] * std::abs(passing.load[i] + nonlinear_parameters[0] +
                                                nonlinear_parameters[1] * passing.friction[i]);
        }
      });
  const double most = std::max(passing.largest, 2.0 * std::abs(passing.offset));
  term.nonlinear_parameters = {{-most, most, 0.05 * passing.largest, true}, {0.0, 1.2, 0.2, true}};
  term.starts = [grid, term, offset = passing.offset](const WeightedResidual& residual) {
    return BestStarts(*grid, term, {{0.0, 0.0}, {offset, 0.0}, {0.0, 1.0}, {offset, 1.0}}, residual, 1);
  };
  const std::string constant = "constant_load_" + units.torque();
  DescribeEach(
      term, {{"load_coefficient", "1", 1.0}, {constant, units.torque(), 1.0}, {"friction_share", "1", 1.0}});
  model.causes.push_back(std::move(term));
  model.rules.push_back(
      {.name = "load_dependent_friction",
       .what_to_do = "run the extended model under load; record at two more loads to prove its slope",
       .sentence =
           "friction rises with the torque that is transmitted: sliding of the teeth and of the flexspline",
       .where = Where::kUnit,
       .effect = "E9",
       .parameters = {{"load_coefficient", "1", 0.0, kMostCoefficient, true}},
       .degrees_of_freedom = 3,
       // What counts as load is open by two nonlinear parameters: of 260 clean records 6 had p < 0.05 with a
       // sixth of these.
       .trials_factor = 12.0,
       .to_settle = units.linear
                        ? ""
                        : "# the same speed under another load\n- kind: load_run\n  name: other-load\n"
                          "  duration: 5 min\n  output_torque: 20 Nm\n  input_speed: 500 rpm\n"});
}

}  // namespace strainwave::analysis::diagnosis
