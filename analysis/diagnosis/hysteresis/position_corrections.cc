// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/hysteresis/correction.h"
#include "analysis/diagnosis/hysteresis/jumps.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kStarts = 3;        // of either form
constexpr double kNarrowest = 1 / 150.0;  // of the way from end to end
constexpr double kWidest = 0.3;

// Something that the twist does at one position of its path, each time it comes by: a bell, or a step to
// another level beyond it. Over the torque, or over the output angle, where both branches have it as they are
// and not friction apart. Numbers: 0 for a bell, 1 for a step; height; centre; full width, of the bell at
// half its height, of the step from a twentieth to nineteen of them.
class PositionWindow final : public LoopEffect {
 public:
  PositionWindow(const LoopRecords& records, bool over_torque) : over_torque_(over_torque) {
    const double most = ArcminFromRad(records.twist_range_rad);
    const double half = over_torque ? records.peak_torque_Nm : records.twist_range_rad;
    span_ = over_torque ? 2.0 * half : half;
    numbers = {{0.0, 1.0, 0.0, true, false},
               {-most, most, 1e-6 * most, false, true},
               {-half, half, 1e-5 * span_, false, false},
               {0.3 * kNarrowest * span_, 2.0 * kWidest * span_, 1e-5 * span_, false, false}};
    needs_all_samples = true;
    rule = {.name = over_torque ? "window over torque" : "window over output angle",
            .sentence = "the twist is off at one place of its way, each time it comes by",
            .parameters = {{"height_arcmin", "arcmin", -most, most, true},
                           {"step_arcmin", "arcmin", -most, most, true}},
            .degrees_of_freedom = 3,
            .location_parameters = 2,
            // Windows and steps that overlap, in all widths.
            .trials_factor = 2.0 * 12.0 / kNarrowest,
            // One loop comes by two or three times.
            .local = true,
            .named = false};
  }

  void Add(std::span<const double> v, const LoopGrid& grid, const Eigen::VectorXd&,
           Eigen::VectorXd& total_rad) const override {
    const double height_rad = RadFromArcmin(v[1]);
    const bool step = v[0] > 0.5;
    const std::vector<double>& positions = PositionsOf(grid);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double x = 2.0 * (positions[i] - v[2]) / v[3];
      total_rad(static_cast<Eigen::Index>(i)) += height_rad * (step ? Step(x) : Bell(x));
    }
  }

  double LogSearchLocations(std::span<const double> v) const override {
    // However sharp, a step divides the way in two.
    return LogSearchLocationsOfWidth(v[0] > 0.5 ? kWidest * span_ : v[3], kNarrowest * span_,
                                     kWidest * span_);
  }

  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    const std::vector<double> se = ErrorsOf(covariance);
    const char* const suffix = over_torque_ ? "_Nm" : "_arcmin";
    const char* const unit = over_torque_ ? "Nm" : "arcmin";
    const double per_rad = over_torque_ ? 1.0 : ArcminFromRad(1.0);
    const double edge_error = per_rad * StandardErrorOf(covariance(2, 2) + 0.25 * covariance(3, 3));
    return {{v[0] > 0.5 ? "step_arcmin" : "height_arcmin", "arcmin", v[1], se[1]},
            {std::string("from") + suffix, unit, per_rad * (v[2] - 0.5 * v[3]), edge_error},
            {std::string("to") + suffix, unit, per_rad * (v[2] + 0.5 * v[3]), edge_error}};
  }
  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    const double* step = FindParameter(parameters, "step_arcmin");
    const double per_rad = over_torque_ ? 1.0 : ArcminFromRad(1.0);
    const double from =
        RequireParameter(rule, parameters, over_torque_ ? "from_Nm" : "from_arcmin") / per_rad;
    const double to = RequireParameter(rule, parameters, over_torque_ ? "to_Nm" : "to_arcmin") / per_rad;
    return {step == nullptr ? 0.0 : 1.0,
            step == nullptr ? RequireParameter(rule, parameters, "height_arcmin") : *step, 0.5 * (from + to),
            to - from};
  }

  std::vector<std::vector<double>> Starts(const LoopResidual& residual) const override {
    const std::vector<double>& positions = PositionsOf(residual.grid);
    std::vector<std::vector<double>> starts;
    for (const WindowPeak& peak : FindWindows(positions, residual.residual_rad, residual.grid.weight,
                                              kNarrowest * span_, kWidest * span_, kStarts))
      starts.push_back({0.0, 0.0, peak.centre, peak.width});
    std::vector<std::size_t> order(positions.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return positions[i]; });
    std::vector<double> weights;
    std::vector<double> in_order_rad;
    for (const std::size_t i : order) {
      weights.push_back(residual.grid.weight[i]);
      in_order_rad.push_back(residual.residual_rad[i]);
    }
    for (const std::size_t jump : BestJumps(weights, in_order_rad, kStarts))
      starts.push_back({1.0, 0.0, positions[order[jump]], 3.0 * kNarrowest * span_});
    return starts;
  }

 private:
  static constexpr double kStepSlope = 1.5;  // tanh: nine tenths of the way within the width
  static constexpr double kStepEnds = 12.0;  // is done then to a double's last digit

  static double Step(double x) {
    return std::abs(x) < kStepEnds ? 0.5 + 0.5 * std::tanh(kStepSlope * x) : (x > 0.0 ? 1.0 : 0.0);
  }

  const std::vector<double>& PositionsOf(const LoopGrid& grid) const {
    return over_torque_ ? grid.torque_Nm : grid.position_rad;
  }

  bool over_torque_;
  double span_{};
};

}  // namespace

void AppendPositionNuisanceTerms(const LoopRecords& records, LoopEffects& effects) {
  effects.push_back(std::make_unique<PositionWindow>(records, true));
  effects.push_back(std::make_unique<PositionWindow>(records, false));
}

}  // namespace strainwave::analysis::diagnosis
