// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/motion/backlash.h"
#include "analysis/diagnosis/motion/terms.h"
#include "analysis/model/axis_motion.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

// Below that it is a tone in time and not a structure.
constexpr double kLeastDamping = 0.004;
constexpr double kMostShare = 1.5;  // of the inertia, that may swing
constexpr double kUnlimited = std::numeric_limits<double>::max();

double DurationOf(const MotionGrid& grid) {
  double duration_s = 0.0;
  for (const MotionGrid::Stretch& stretch : grid.stretches) {
    duration_s += stretch.step_s * static_cast<double>(stretch.count);
  }
  return duration_s;
}

void AddResonance(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  const double low_Hz = std::max(4.0 / DurationOf(*grid), 1e-3);
  // A ring that a jolt started may be faster than the motion.
  const double high_Hz =
      std::min(1.2 * grid->cutoff_rad_per_s(), 4.0 * grid->path_cutoff_rad_per_s()) / kTwoPi;
  if (!(high_Hz > 3.0 * low_Hz)) return;
  const auto longest = std::ranges::max_element(grid->stretches, {}, &MotionGrid::Stretch::count);
  const double usual = UsualSize(grid->passed_acceleration);
  SeparableTerm term;
  term.fill = [grid, first = longest->first, count = longest->count, usual](
                  std::span<const double> shapes, Eigen::Ref<Eigen::MatrixXd> design) {
    const double natural = kTwoPi * std::exp(shapes[0]);
    const double damping = std::exp(shapes[1]);
    std::vector<double> points(grid->time_s.size());
    for (const MotionGrid::Stretch& stretch : grid->stretches) {
      model::SecondInertia inertia(natural, damping, stretch.step_s);
      for (std::size_t i = stretch.first; i < stretch.first + stretch.count; ++i) {
        points[i] = inertia.Step(grid->passed_acceleration[i]);
      }
    }
    if (shapes[2] != 0.0 || shapes[3] != 0.0) {
      for (std::size_t i = first; i < first + count; ++i) {
        const double turned = natural * (grid->time_s[i] - grid->time_s[first]);
        points[i] += usual * std::exp(-damping * turned) *
                     (shapes[2] * std::cos(turned) + shapes[3] * std::sin(turned));
      }
    }
    design.col(0) = grid->ProjectPassed(points);
  };
  // It may swing already where the record begins: over the usual acceleration of the motion, in phase and a
  // quarter of a turn later.
  const ShapeRange at_start{-3.0, 3.0, 0.1, true, Moved::kForReport};
  term.shapes = {{std::log(low_Hz), std::log(high_Hz), 0.03},
                 {std::log(kLeastDamping), std::log(0.8), 0.3, true},
                 at_start,
                 at_start};

  std::vector<std::vector<double>> tried;  // ln frequency in Hz, ln damping ratio
  for (const auto& [damping, spacing] :
       {std::pair{0.02, 0.03}, std::pair{0.07, 0.08}, std::pair{0.3, 0.25}}) {
    for (double log_Hz = std::log(low_Hz) + spacing; log_Hz < std::log(high_Hz); log_Hz += spacing) {
      tried.push_back({log_Hz, std::log(damping), 0.0, 0.0});
    }
  }
  const double reference = std::max(grid->prefit(0), 1e-300);
  const auto map = std::make_shared<ShapeMap>(*grid, std::move(tried));
  FillMaps(term, grid->rows(), {map.get()});
  term.starts = [map, reference](const Remainder& remainder) {
    std::vector<std::vector<double>> starts;
    Eigen::VectorXf left = map->Roots(remainder);
    // Far above the motion a swing of any inertia looks alike, up to what no axis carries.
    for (Index k = 0; k < left.size(); ++k) {
      if (map->Coefficient(k, static_cast<double>(left(k))) > kMostShare * reference) left(k) = 0.0F;
    }
    while (starts.size() < 3) {
      Index best = 0;
      if (!(left.maxCoeff(&best) > 0.0F)) break;
      const std::vector<double>& shape = map->shapes()[static_cast<std::size_t>(best)];
      starts.push_back(shape);
      for (Index k = 0; k < left.size(); ++k) {
        if (std::abs(map->shapes()[static_cast<std::size_t>(k)][0] - shape[0]) < 0.15) left(k) = 0.0F;
      }
    }
    return starts;
  };
  const std::string inertia = units.linear ? "second_mass_kg" : "second_inertia_kgm2";
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    const double frequency_Hz = std::exp(numbers[1]);
    const double damping = std::exp(numbers[2]);
    const double error = StandardErrorOf(covariance(0, 0));
    // What the swing adds below its frequency, J₂/ω², is known even where frequency and inertia are not.
    const double weight = numbers[0] / std::pow(kTwoPi * frequency_Hz, 2);
    const double slope = std::abs(weight) / std::max(std::abs(numbers[0]), 1e-300);
    const double weight_error =
        StandardErrorOf(slope * slope * covariance(0, 0) + 4.0 * weight * weight * covariance(1, 1) -
                        4.0 * weight * slope * covariance(0, 1));
    return std::vector<ParameterValue>{
        {"frequency_Hz", "Hz", frequency_Hz, frequency_Hz * StandardErrorOf(covariance(1, 1))},
        {"damping_ratio", "1", damping, damping * StandardErrorOf(covariance(2, 2))},
        {"inertia_share", "1", numbers[0] / reference, error / reference},
        {inertia, units.inertia(), numbers[0], error},
        {inertia + "s2", units.inertia() + " s²", weight, weight_error},
        {"swing_at_start", "1", numbers[3], StandardErrorOf(covariance(3, 3))},
        {"swing_at_start_late", "1", numbers[4], StandardErrorOf(covariance(4, 4))}};
  };
  term.restore = [](std::span<const double> values) {
    return std::vector<double>{values[3], std::log(std::max(values[0], 1e-9)),
                               std::log(std::max(values[1], 1e-9)), values[5], values[6]};
  };
  model.causes.push_back(std::move(term));
  model.rules.push_back({.name = "torsional_resonance",
                         .sentence = "a second inertia behind a compliance swings: a soft coupling, shaft, "
                                     "screw or gear between drive and load",
                         .where = Where::kUndecided,
                         .effect = "E15",
                         .parameters = {{"inertia_share", "1", 0.0, kMostShare, false},
                                        {inertia + "s2", units.inertia() + " s²", 0.0, kUnlimited, true},
                                        {"frequency_Hz", "Hz", 1.02 * low_Hz, 0.98 * high_Hz, false},
                                        {"damping_ratio", "1", 1.1 * kLeastDamping, 0.4, false}},
                         .degrees_of_freedom = 3,
                         .trials = std::max(10.0, 10.0 * std::log(high_Hz / low_Hz)),
                         // What tells its frequency may be one short jolt.
                         .local = true,
                         .to_settle = units.linear ? ""
                                                   : "# the same motion with another inertia on the output: "
                                                     "the frequency moves if the compliance is the unit's\n"
                                                     "- kind: load_run\n  name: other-inertia\n  duration: 1 "
                                                     "min\n  output_torque: 0 Nm\n  input_speed: 500 rpm\n"});
}

}  // namespace

void AddDynamicCauses(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  AddResonance(grid, units, model);
  AddBacklash(grid, units, model);
}

}  // namespace strainwave::analysis::diagnosis
