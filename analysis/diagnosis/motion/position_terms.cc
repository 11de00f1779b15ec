// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/diagnosis/motion/terms.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kHighestPerTurn = 1200.0;
constexpr double kHighestPerM = 2e5;

// Position in turns of what orders count: radians, or for a linear axis 2π times metres.
std::vector<double> AngleOf(const std::vector<double>& position, bool linear) {
  std::vector<double> angle = position;
  if (linear) {
    for (double& value : angle) value *= kTwoPi;
  }
  return angle;
}

std::vector<double> AtRows(const MotionGrid& grid, const std::vector<double>& points) {
  std::vector<double> values;
  values.reserve(grid.rows());
  for (const std::size_t point : grid.point_of_row) values.push_back(points[point]);
  return values;
}

// Orders that a record can tell.
struct OrderRange {
  double low{};
  double high{};
  double cell{};  // that tells two orders apart
};

OrderRange OrdersOf(const MotionGrid& grid, double turns, bool linear) {
  // Slower than one and a half periods in the record it is a smooth function of position; faster than the
  // low-pass lets through at the slow end of the motion, or than the position resolves, it leaves no trace.
  const double slow = QuantileOfMagnitude(AngleOf(grid.velocity, linear), 0.25);
  double high = linear ? kHighestPerM : kHighestPerTurn;
  if (slow > 0.0) high = std::min(high, grid.cutoff_rad_per_s() / slow);
  if (grid.position_noise > 0.0) high = std::min(high, 0.5 / (grid.position_noise * (linear ? kTwoPi : 1.0)));
  return {std::max(linear ? 0.0 : 0.5, 1.5 / turns), high, 1.0 / turns};
}

// A torque that repeats with position, or a friction, which turns with the direction.
enum class Ripple { kTorque, kFriction };

SeparableTerm RippleTerm(const SharedGrid& grid, const std::vector<double>& angle, const OrderRange& orders,
                         Ripple ripple, bool linear) {
  const std::vector<double> sign =
      ripple == Ripple::kFriction ? grid->direction : std::vector<double>(angle.size(), 1.0);
  SeparableTerm term = PointTerm(grid, 2,
                                 [angle, sign](std::span<const double> nonlinear_parameters,
                                               std::size_t column, std::span<double> points) {
                                   for (std::size_t i = 0; i < points.size(); ++i) {
                                     const double at = nonlinear_parameters[0] * angle[i];
                                     points[i] = sign[i] * (column == 0 ? std::cos(at) : std::sin(at));
                                   }
                                 });
  term.nonlinear_parameters = {{0.9 * orders.low, 1.1 * orders.high, 0.2 * orders.cell}};
  // A line of one per turn is gravity's.
  const auto is_gravity = [=](double order) {
    return ripple == Ripple::kTorque && !linear && std::abs(order - 1.0) < 0.1 * orders.cell;
  };
  const std::vector<double> angle_at_rows = AtRows(*grid, angle);
  const std::vector<double> sign_at_rows = AtRows(*grid, sign);
  term.starts = [=](const WeightedResidual& residual) {
    std::vector<double> signed_values(residual.values.begin(), residual.values.end());
    for (std::size_t i = 0; i < signed_values.size(); ++i) signed_values[i] *= sign_at_rows[i];
    std::vector<std::vector<double>> starts;
    for (const LinePeak& peak :
         FindLines(angle_at_rows, signed_values, residual.weights, orders.low, orders.high, 5)) {
      if (!is_gravity(peak.order) && starts.size() < 3) starts.push_back({peak.order});
    }
    return starts;
  };
  term.log_search_locations = [orders](std::span<const double> nonlinear_parameters) {
    return LogSearchLocationsOfLine(nonlinear_parameters[0], orders.low, orders.high);
  };
  return term;
}

void AddRipples(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const std::vector<double> angle = AngleOf(grid->position, units.linear);
  const std::vector<double> angle_at_rows = AtRows(*grid, angle);
  const auto [first, last] = std::minmax_element(angle_at_rows.begin(), angle_at_rows.end());
  const double turns = (*last - *first) / kTwoPi;
  const OrderRange orders = OrdersOf(*grid, turns, units.linear);
  if (!(orders.high > 2.0 * orders.low)) {
    model.warnings.push_back(
        fmt::format("no verdict on position_periodic_torque: the axis moves over {:.3g} {} only, or too "
                    "fast for its sampling",
                    units.linear ? *last / kTwoPi - *first / kTwoPi : turns, units.linear ? "m" : "turns"));
    return;
  }
  const std::string order = units.linear ? "periods_per_m" : "order_per_turn";
  const std::string per = units.linear ? "1/m" : "1";
  const auto add = [&](Ripple ripple, const std::string& sentence, const std::string& to_settle) {
    SeparableTerm term = RippleTerm(grid, angle, orders, ripple, units.linear);
    const std::string amplitude =
        (ripple == Ripple::kFriction ? "friction_amplitude_" : "amplitude_") + units.torque();
    DescribeAsHarmonic(term, amplitude, units.torque(), 1.0, {{order, per, 1.0}});
    model.causes.push_back(std::move(term));
    model.rules.push_back({.name = "position_periodic_torque",
                           .what_to_do = "compare the order named with poles, teeth and rolling elements of "
                                         "the axis; record again uncoupled",
                           .sentence = sentence,
                           .where = Where::kUndecided,
                           .effect = "E13",
                           .parameters = {{amplitude, units.torque(), 0.0, kUnlimited, true},
                                          {order, per, orders.low, orders.high, false}},
                           .degrees_of_freedom = 3,
                           .trials_factor = IndependentOrders(angle_at_rows, orders.low, orders.high),
                           .to_settle = units.linear ? "" : to_settle});
  };
  add(Ripple::kTorque,
      units.linear ? "a force that repeats with position: the pitch of a screw, magnets, balls or teeth"
                   : "a torque that repeats with position: cogging of the motor (slots and poles), teeth "
                     "of the gear, "
                     "an encoder or coupling off centre",
      "# without the gear cogging stays, with it and at another speed the gear's own "
      "goes with the turn\n"
      "- kind: load_run\n  name: other-speed\n  duration: 5 min\n  output_torque: 0 Nm\n"
      "  input_speed: 100 rpm\n");
  // One direction does not tell it from a torque.
  if (MovesBothWays(*grid)) {
    add(Ripple::kFriction,
        "a friction that repeats with position, against the motion: a seal or bearing off centre, teeth or "
        "rolling elements that run tight",
        "# the same turns both ways: a friction changes its sign with the direction, a torque does not\n"
        "- {kind: measurement_rotation, name: there, turns: 1, direction: cw, output_torque: 0 Nm, "
        "input_speed: 100 rpm}\n"
        "- {kind: measurement_rotation, name: back, turns: 1, direction: ccw, output_torque: 0 Nm, "
        "input_speed: 100 rpm}\n");
  }
}

void AddGravity(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  if (units.linear) return;
  const auto [first, last] = std::minmax_element(grid->position.begin(), grid->position.end());
  if (*last - *first < 0.5) {
    model.warnings.push_back(fmt::format(
        "no verdict on gravity_load: the axis turns by {:.3g} degrees only (expected 30 and more)",
        DegFromRad(*last - *first)));
    return;
  }
  Eigen::MatrixXd columns(grid->nominal.rows(), 2);
  std::vector<double> points(grid->position.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = std::cos(grid->position[i]);
  columns.col(0) = grid->Project(points);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = std::sin(grid->position[i]);
  columns.col(1) = grid->Project(points);
  SeparableTerm term = FixedTerm(std::move(columns));
  DescribeAsHarmonic(term, "amplitude_Nm", "Nm", 1.0);
  model.causes.push_back(std::move(term));
  model.rules.push_back(
      {.name = "gravity_load",
       .what_to_do = "balance what the axis carries, or run the extended model, which has its weight",
       .sentence = "a torque once per turn, sine of the position: weight off the axis, of what the axis "
                   "carries or of the bench",
       .where = Where::kUndecided,
       .effect = "E21",
       .parameters = {{"amplitude_Nm", "Nm", 0.0, kUnlimited, true}},
       .degrees_of_freedom = 2,
       .aliases = {"position_periodic_torque"},
       .to_settle =
           "# turn the lever or flange by 90 degrees on the axis: weight of the bench turns with it\n"
           "- kind: load_run\n  name: slow-turns\n  duration: 5 min\n  output_torque: 0 Nm\n  input_speed: "
           "50 rpm\n"});
}

}  // namespace

void AddPositionCauses(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  AddRipples(grid, units, model);
  AddGravity(grid, units, model);
}

}  // namespace strainwave::analysis::diagnosis
