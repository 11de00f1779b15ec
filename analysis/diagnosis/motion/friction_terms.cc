// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/motion/terms.h"
#include "analysis/model/axis_motion.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kMisfitOfFriction = 0.001;  // of squares; its laws are fits to what was measured
constexpr double kExcited = 0.0005;    // of a column's variance that has to lie beside the nominal terms
constexpr double kFewestShare = 0.01;  // of the motion that a regime of speed has to make up

void NotExcited(SeparableModel& model, const char* cause, const std::string& why) {
  model.warnings.push_back(fmt::format("no verdict on {}: {}", cause, why));
}

void Add(SeparableModel& model, SeparableTerm term, CauseRule rule) {
  model.causes.push_back(std::move(term));
  model.rules.push_back(std::move(rule));
}

void AddStribeck(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const double fast = QuantileOfMagnitude(grid->velocity, 0.95);
  const double slow = QuantileOfMagnitude(grid->velocity, kFewestShare);
  const double low = std::max({slow, 3.0 * grid->reversal_smoothing.width, 0.005 * fast});
  const double high = 0.5 * fast;
  if (!(high > 3.0 * low)) {
    NotExcited(model, "stribeck_friction",
               fmt::format("speeds from {:.3g} to {:.3g} {} only (expected slow motion, too)", slow, fast,
                           units.speed()));
    return;
  }
  SeparableTerm term = PointTerm(
      grid, 1, [grid](std::span<const double> nonlinear_parameters, std::size_t, std::span<double> points) {
        const double speed = std::exp(nonlinear_parameters[0]);
        for (std::size_t i = 0; i < points.size(); ++i) {
          points[i] =
              grid->direction[i] * model::StribeckShare(grid->velocity[i], speed, nonlinear_parameters[1]);
        }
      });
  // Exponents from 0.5 on have been measured; but below this the fall begins at once and goes on so long that
  // it passes for Coulomb friction and any speed.
  term.nonlinear_parameters = {{std::log(low), std::log(high), 0.3, true}, {0.75, 2.5, 0.2, true}};
  term.starts = [grid, term, low, high](const WeightedResidual& residual) {
    std::vector<std::vector<double>> candidates;
    for (const double speed : GeometricSteps(1.1 * low, 0.9 * high, 8))
      candidates.push_back({std::log(speed), 1.5});
    return BestStarts(*grid, term, candidates, residual, 2);
  };
  const std::string amount = "stribeck_" + units.torque();
  const std::string speed = "stribeck_speed_" + units.speed_suffix();
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    const double at = std::exp(numbers[1]);
    return std::vector<ParameterValue>{
        {amount, units.torque(), numbers[0], StandardErrorOf(covariance(0, 0))},
        {speed, units.speed(), at, at * StandardErrorOf(covariance(1, 1))},
        {"stribeck_exponent", "1", numbers[2], StandardErrorOf(covariance(2, 2))}};
  };
  term.restore = [](std::span<const double> values) {
    return std::vector<double>{values[0], std::log(std::max(values[1], 1e-300)), values[2]};
  };
  Add(model, std::move(term),
      {.name = "stribeck_friction",
       .what_to_do = "run the extended model at low speed; look whether the lubricant suits that speed",
       .sentence = "friction falls with speed at low speed: the lubricant film is not closed yet (Stribeck)",
       .where = Where::kUnit,
       .effect = "E8",
       // Height at rest, speed and exponent may stand for each other, so that none of them is known where
       // their curve is: it is for the likelihood to say whether there is one.
       .parameters = {{amount, units.torque(), 0.0, kUnlimited, false},
                      {speed, units.speed(), 1.01 * low, 0.99 * high, false}},
       .degrees_of_freedom = 3,
       .trials_factor = 4.0,
       .misfit_share = kMisfitOfFriction,
       .to_settle =
           units.linear
               ? ""
               : "# steady turns at several low speeds, both ways\n- kind: load_run\n  name: slow-turns\n"
                 "  duration: 5 min\n  output_torque: 0 Nm\n  input_speed: 20 rpm\n"});
}

void AddAsymmetry(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  std::vector<double> points(grid->velocity.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = 0.5 * grid->direction[i] * grid->velocity[i];
  Eigen::VectorXd column = grid->Project(points);
  if (!MovesBothWays(*grid)) {
    NotExcited(model, "asymmetric_friction", "the axis moves in one direction only (expected both)");
    return;
  }
  if (ShareBesideNominal(*grid, column) < kExcited) {
    NotExcited(model, "asymmetric_friction", "one speed only in each direction (expected several)");
    return;
  }
  SeparableTerm term = FixedTerm(std::move(column));
  const std::string name = "viscous_difference_" + units.viscous_suffix();
  DescribeEach(term, {{name, units.viscous(), 1.0}});
  Add(model, std::move(term),
      {.name = "asymmetric_friction",
       .what_to_do = "record again without load: a load on one flank goes away with it, wear stays; then "
                     "look at the flanks",
       .sentence = "friction at equal speed differs by direction: one flank of the teeth, or of the screw, "
                   "is worn or "
                   "carries another load",
       .where = Where::kUnit,
       .parameters = {{name, units.viscous(), -kUnlimited, kUnlimited, true}}});
}

void AddDrag(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  std::vector<double> points(grid->velocity.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = grid->velocity[i] * std::abs(grid->velocity[i]);
  Eigen::VectorXd column = grid->Project(points);
  if (ShareBesideNominal(*grid, column) < kExcited) {
    NotExcited(model, "quadratic_drag", "speeds are too much alike (expected slow and fast motion)");
    return;
  }
  SeparableTerm term = FixedTerm(std::move(column));
  const std::string name = units.linear ? "drag_Ns2_per_m2" : "drag_Nms2_per_rad2";
  const std::string unit = units.linear ? "Ns²/m²" : "Nms²/rad²";
  DescribeEach(term, {{name, unit, 1.0}});
  Add(model, std::move(term),
      {.name = "quadratic_drag",
       .what_to_do = "check the fill of grease or oil, and run the extended model at high speed",
       .sentence = "a resistance that rises with the square of speed: churning of grease or oil, or air",
       .where = Where::kUnit,
       .parameters = {{name, unit, 0.0, kUnlimited, true}},
       .misfit_share = kMisfitOfFriction});
}

void AddThermalDrift(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const bool by_temperature = !grid->temperature_degC.empty();
  const std::vector<double>& follows = by_temperature ? grid->temperature_degC : grid->time_s;
  const auto [low, high] = std::minmax_element(follows.begin(), follows.end());
  const double range = *high - *low;
  if (by_temperature ? range < 1.0 : range < 8.0) {
    NotExcited(model, "thermal_friction_drift",
               by_temperature
                   ? fmt::format("temperature changes by {:.2g} K only (expected 1 K and more)", range)
                   : fmt::format("the record lasts {:.2g} s, without temperature (expected minutes)", range));
    return;
  }
  const double per_unit = by_temperature ? 1.0 : 1.0 / 3600.0;
  // What the friction follows: temperature, or time that saturates with the time constant in `nonlinear
  // parameters`, scaled so that its rate is the mean one of the record. Less its mean, so that the nominal
  // friction is the mean.
  const auto followed = [grid, by_temperature, low = *low, range,
                         per_unit](std::span<const double> nonlinear_parameters) {
    std::vector<double> values = by_temperature ? grid->temperature_degC : grid->time_s;
    if (!nonlinear_parameters.empty()) {
      const double scale = range / -std::expm1(-range / std::exp(nonlinear_parameters[0]));
      for (double& value : values)
        value = -scale * std::expm1(-(value - low) / std::exp(nonlinear_parameters[0]));
    }
    double mean = 0.0;
    for (const double value : values) mean += value / static_cast<double>(values.size());
    for (double& value : values) value = (value - mean) * per_unit;
    return values;
  };
  SeparableTerm term;
  term.columns = 2;
  term.fill = [grid, followed](std::span<const double> nonlinear_parameters,
                               Eigen::Ref<Eigen::MatrixXd> design) {
    const std::vector<double> drift = followed(nonlinear_parameters);
    std::vector<double> points(drift.size());
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = drift[i] * grid->velocity[i];
    design.col(0) = grid->Project(points);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = drift[i] * grid->direction[i];
    design.col(1) = grid->Project(points);
  };
  if (!by_temperature) {
    term.nonlinear_parameters = {{std::log(0.05 * range), std::log(20.0 * range), 0.3, true}};
    term.starts = [range](const WeightedResidual&) {
      return std::vector<std::vector<double>>{{std::log(10.0 * range)}, {std::log(0.3 * range)}};
    };
  }
  Eigen::MatrixXd columns(grid->nominal.rows(), 2);
  term.fill(by_temperature ? std::vector<double>{} : std::vector<double>{std::log(10.0 * range)}, columns);
  if (ShareBesideNominal(*grid, columns.col(0)) < kExcited &&
      ShareBesideNominal(*grid, columns.col(1)) < kExcited) {
    NotExcited(model, "thermal_friction_drift",
               "temperature and motion go together (expected the same motion again later)");
    return;
  }
  if (by_temperature) term = FixedTerm(std::move(columns));
  double top_speed = 0.0;
  for (const double velocity : grid->velocity) top_speed = std::max(top_speed, std::abs(velocity));
  const double nominal_viscous = grid->prefit(1);
  const double nominal_coulomb = grid->prefit(2);
  const std::string suffix = by_temperature ? "per_K" : "per_h";
  const std::string inverse = by_temperature ? "1/K" : "1/h";
  const std::string viscous = fmt::format("viscous_drift_{}_{}", units.viscous_suffix(), suffix);
  const std::string coulomb = fmt::format("coulomb_drift_{}_{}", units.torque(), suffix);
  const std::string per = by_temperature ? "/K" : "/h";
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    // Relative drift of the friction, related to its start, at the speed at which it is known best: a record
    // that goes through its speeds once cannot part the drift of viscous friction from that of the other.
    const double known_best = covariance(0, 0) > 0.0 ? -covariance(0, 1) / covariance(0, 0) : 0.0;
    const Eigen::Vector2d weights(std::clamp(known_best, 0.0, top_speed), 1.0);
    const double friction = std::max(nominal_viscous * weights(0) + nominal_coulomb, 1e-300);
    const double slope = numbers[0] * weights(0) + numbers[1];
    const double at_start = friction + slope * followed(numbers.subspan(2)).front();
    const double slope_error = StandardErrorOf(weights.dot(covariance.topLeftCorner<2, 2>() * weights));
    std::vector<ParameterValue> values{
        {"drift_" + suffix, inverse, slope / at_start, slope_error * friction / (at_start * at_start)},
        {viscous, units.viscous() + per, numbers[0], StandardErrorOf(covariance(0, 0))},
        {coulomb, units.torque() + per, numbers[1], StandardErrorOf(covariance(1, 1))}};
    if (numbers.size() > 2) {
      const double time_constant_s = std::exp(numbers[2]);
      values.push_back(
          {"time_constant_s", "s", time_constant_s, time_constant_s * StandardErrorOf(covariance(2, 2))});
    }
    return values;
  };
  term.restore = [](std::span<const double> values) {
    std::vector<double> numbers{values[1], values[2]};
    if (values.size() > 3) numbers.push_back(std::log(std::max(values[3], 1e-300)));
    return numbers;
  };
  Add(model, std::move(term),
      {.name = "thermal_friction_drift",
       .what_to_do = "warm the drive up before it is measured, and log its temperature",
       .sentence = by_temperature ? "friction follows temperature: the grease thins or thickens"
                                  : "friction changes in the course of the record: grease that warms or "
                                    "cools (no temperature in "
                                    "the record to prove it)",
       .where = Where::kUnit,
       .effect = "E10",
       .parameters = {{"drift_" + suffix, inverse, -kUnlimited, kUnlimited, true}},
       .degrees_of_freedom = by_temperature ? 2 : 3,
       .trials_factor = by_temperature ? 1.0 : 2.0,
       .to_settle = units.linear ? ""
                                 : "# the same motion on a cold gear and on a warm one, with temperature "
                                   "recorded\n- {kind: soak, below_temperature: 25 degC, at_most: 1 h}\n"});
}

}  // namespace

void AddFrictionCauses(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  AddStribeck(grid, units, model);
  AddAsymmetry(grid, units, model);
  AddDrag(grid, units, model);
  AddThermalDrift(grid, units, model);
}

}  // namespace strainwave::analysis::diagnosis
