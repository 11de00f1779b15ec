// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "analysis/diagnosis/motion_terms.h"
#include "analysis/model/axis_motion.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr double kUnlimited = std::numeric_limits<double>::max();

double RootOf(double variance) { return std::sqrt(std::max(0.0, variance)); }

double DurationOf(const MotionGrid& grid) {
  double duration_s = 0.0;
  for (const MotionGrid::Stretch& stretch : grid.stretches) {
    duration_s += stretch.step_s * static_cast<double>(stretch.count);
  }
  return duration_s;
}

// Shapes of a resonance that are tried, and their columns beside the nominal model, each of length 1.
struct ResonanceMap {
  std::vector<std::vector<double>> shapes;  // ln frequency in Hz, ln damping ratio
  Eigen::MatrixXf columns;
};

void AddResonance(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const double low_Hz = std::max(4.0 / DurationOf(*grid), 1e-3);
  const double high_Hz = 1.2 * grid->cutoff_rad_per_s / kTwoPi;
  if (!(high_Hz > 3.0 * low_Hz)) return;
  SeparableTerm term;
  term.fill = [grid](std::span<const double> shapes, Eigen::Ref<Eigen::MatrixXd> design) {
    const double natural = kTwoPi * std::exp(shapes[0]);
    const double damping = std::exp(shapes[1]);
    std::vector<double> points(grid->time_s.size());
    for (const MotionGrid::Stretch& stretch : grid->stretches) {
      model::SecondInertia inertia(natural, damping, stretch.step_s);
      for (std::size_t i = stretch.first; i < stretch.first + stretch.count; ++i) {
        points[i] = inertia.Step(grid->passed_acceleration[i]);
      }
    }
    design.col(0) = grid->ProjectPassed(points);
  };
  term.shapes = {{std::log(low_Hz), std::log(high_Hz), 0.03}, {std::log(0.004), std::log(0.8), 0.3}};

  ResonanceMap map;
  for (const auto& [damping, spacing] :
       {std::pair{0.02, 0.03}, std::pair{0.07, 0.08}, std::pair{0.3, 0.25}}) {
    for (double log_Hz = std::log(low_Hz) + spacing; log_Hz < std::log(high_Hz); log_Hz += spacing) {
      map.shapes.push_back({log_Hz, std::log(damping)});
    }
  }
  map.columns.resize(grid->nominal.rows(), static_cast<Index>(map.shapes.size()));
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> nominal(grid->nominal);
  Eigen::MatrixXd column(grid->nominal.rows(), 1);
  for (std::size_t k = 0; k < map.shapes.size(); ++k) {
    term.fill(map.shapes[k], column);
    const double before = column.norm();
    column -= grid->nominal * nominal.solve(column);
    const double norm = column.norm();
    const bool distinct = norm > 1e-3 * before;  // far above the motion it is one with the inertia
    map.columns.col(static_cast<Index>(k)) =
        distinct ? Eigen::VectorXf((column / norm).cast<float>()) : Eigen::VectorXf::Zero(column.rows());
  }
  term.starts = [map = std::make_shared<const ResonanceMap>(std::move(map))](const Remainder& remainder) {
    const auto rows = static_cast<Index>(remainder.residual.size());
    const Eigen::VectorXf weighted =
        Eigen::Map<const Eigen::VectorXd>(remainder.residual.data(), rows)
            .cwiseProduct(Eigen::Map<const Eigen::VectorXd>(remainder.weights.data(), rows))
            .cast<float>();
    const Eigen::VectorXf drops = (map->columns.transpose() * weighted).cwiseAbs();
    std::vector<std::vector<double>> starts;
    Eigen::VectorXf left = drops;
    while (starts.size() < 3) {
      Index best = 0;
      if (!(left.maxCoeff(&best) > 0.0F)) break;
      const std::vector<double>& shape = map->shapes[static_cast<std::size_t>(best)];
      starts.push_back(shape);
      for (std::size_t k = 0; k < map->shapes.size(); ++k) {
        if (std::abs(map->shapes[k][0] - shape[0]) < 0.15) left(static_cast<Index>(k)) = 0.0F;
      }
    }
    return starts;
  };
  const double reference = std::max(grid->prefit(0), 1e-300);
  const std::string inertia = units.linear ? "second_mass_kg" : "second_inertia_kgm2";
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    const double frequency_Hz = std::exp(numbers[1]);
    const double damping = std::exp(numbers[2]);
    const double error = RootOf(covariance(0, 0));
    return std::vector<ParameterValue>{
        {"frequency_Hz", "Hz", frequency_Hz, frequency_Hz * RootOf(covariance(1, 1))},
        {"damping_ratio", "1", damping, damping * RootOf(covariance(2, 2))},
        {"inertia_share", "1", numbers[0] / reference, error / reference},
        {inertia, units.inertia(), numbers[0], error}};
  };
  term.restore = [](std::span<const double> values) {
    return std::vector<double>{values[3], std::log(std::max(values[0], 1e-9)),
                               std::log(std::max(values[1], 1e-9))};
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = "torsional_resonance",
                         .sentence = "a second inertia behind a compliance swings: a soft coupling, shaft, "
                                     "screw or gear between drive and load",
                         .where = Where::kUndecided,
                         .effect = "E15",
                         .parameters = {{"inertia_share", "1", 0.0, 1.5, true},
                                        {"frequency_Hz", "Hz", 1.02 * low_Hz, 0.98 * high_Hz, false},
                                        {"damping_ratio", "1", 0.0, 0.75, false}},
                         .degrees_of_freedom = 3,
                         .trials = std::max(4.0, 4.0 * std::log(high_Hz / low_Hz)),
                         .to_settle = units.linear ? ""
                                                   : "# the same motion with another inertia on the output: "
                                                     "the frequency moves if the compliance is the unit's\n"
                                                     "- kind: load_run\n  name: other-inertia\n  duration: 1 "
                                                     "min\n  output_torque: 0 Nm\n  input_speed: 500 rpm\n"});
}

void AddBacklash(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const auto [first, last] = std::minmax_element(grid->position.begin(), grid->position.end());
  const double low = std::max(6.0 * grid->position_noise, 1e-6 * (*last - *first));
  const double high = 0.25 * (*last - *first);
  if (!(high > 4.0 * low)) return;
  SeparableTerm term;
  term.columns = 2;
  term.shapes = {{std::log(low), std::log(high), 0.2}};
  term.fill = [grid](std::span<const double> shapes, Eigen::Ref<Eigen::MatrixXd> design) {
    const double width = std::exp(shapes[0]);
    std::vector<double> lag(grid->position.size());
    std::vector<double> missing(grid->position.size());
    for (const MotionGrid::Stretch& stretch : grid->stretches) {
      model::Play play(width, grid->position[stretch.first], grid->velocity[stretch.first]);
      for (std::size_t i = stretch.first; i < stretch.first + stretch.count; ++i) {
        const double near = grid->position[i];
        lag[i] = play.Follow(near) - near;
        const bool apart = std::abs(lag[i]) < 0.5 * width * (1.0 - 1e-9);
        missing[i] = apart ? -grid->direction[i] : 0.0;
      }
    }
    // The far side's own acceleration, contact and all, by the low-pass's second derivative.
    design.col(0) = grid->Project(lag, 2, 0.0);
    design.col(1) = grid->Project(missing);
  };
  term.starts = [grid, term, low, high](const Remainder& remainder) {
    std::vector<std::vector<double>> candidates;
    for (const double width : GeometricSteps(1.2 * low, 0.8 * high, 16))
      candidates.push_back({std::log(width)});
    return BestStarts(*grid, term, candidates, remainder, 2);
  };
  const std::string width = units.linear ? "backlash_m" : "backlash_rad";
  const std::string inertia = units.linear ? "load_mass_kg" : "load_inertia_kgm2";
  const std::string friction = "load_friction_" + units.torque();
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    const double gap = std::exp(numbers[2]);
    return std::vector<ParameterValue>{{width, units.position(), gap, gap * RootOf(covariance(2, 2))},
                                       {inertia, units.inertia(), numbers[0], RootOf(covariance(0, 0))},
                                       {friction, units.torque(), numbers[1], RootOf(covariance(1, 1))}};
  };
  term.restore = [](std::span<const double> values) {
    return std::vector<double>{values[1], values[2], std::log(std::max(values[0], 1e-300))};
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back(
      {.name = "backlash",
       .sentence = "after a reversal the load does not follow until a gap is crossed: play "
                   "in a coupling, key, nut or the teeth",
       .where = Where::kUndecided,
       .effect = "E4",
       .parameters = {{width, units.position(), 1.05 * low, 0.95 * high, true},
                      {inertia, units.inertia(), -0.15 * std::abs(grid->prefit(0)),
                       1.3 * std::abs(grid->prefit(0)), false},
                      {friction, units.torque(), -0.15 * std::abs(grid->prefit(2)),
                       2.0 * std::abs(grid->prefit(2)), false}},
       .degrees_of_freedom = 3,
       .trials = 8.0,
       .to_settle =
           units.linear
               ? ""
               : "# input locked, load to and fro: play of the gear shows as a "
                 "dead zone, that of the drive's coupling does not\n"
                 "- {kind: hysteresis, peak_torque: 34 Nm, torque_rate: 3 Nm/s, hold: 0.5 s, loops: 1}\n"});
}

}  // namespace

void AddDynamicCauses(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  AddResonance(grid, units, model);
  AddBacklash(grid, units, model);
}

}  // namespace strainwave::analysis::diagnosis
