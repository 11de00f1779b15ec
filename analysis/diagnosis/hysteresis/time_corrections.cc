// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/hysteresis/correction.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

double SamplesOfRecord(const LoopRecords& records) {
  return static_cast<double>(records.samples.size()) / static_cast<double>(records.samples.records());
}

// Samples at which the residual's mean changes most, at least a fiftieth of the record apart. A nearby
// stretch either side counts, since fits have taken off what lasts.
std::vector<std::size_t> BestJumps(const LoopGrid& grid, std::span<const double> residual,
                                   std::size_t count) {
  const std::size_t n = grid.size();
  std::vector<double> sum(n + 1, 0.0);
  std::vector<double> weight(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    sum[i + 1] = sum[i] + grid.weight[i] * residual[i];
    weight[i + 1] = weight[i] + grid.weight[i];
  }
  std::vector<std::pair<double, std::size_t>> jumps;
  for (const std::size_t reach : {n / 100, n / 25, n / 8}) {
    for (std::size_t i = reach; reach > 2 && i + reach < n; ++i) {
      const double before = weight[i] - weight[i - reach];
      const double after = weight[i + reach] - weight[i];
      if (!(before > 0.0) || !(after > 0.0)) continue;
      const double step = (sum[i + reach] - sum[i]) / after - (sum[i] - sum[i - reach]) / before;
      jumps.emplace_back(step * step / (1.0 / before + 1.0 / after), i);
    }
  }
  std::sort(jumps.rbegin(), jumps.rend());
  std::vector<std::size_t> best;
  for (const auto& [drop, place] : jumps) {
    const bool close = std::any_of(best.begin(), best.end(), [&, at = place](std::size_t other) {
      return (at > other ? at - other : other - at) < n / 50;
    });
    if (!close) best.push_back(place);
    if (best.size() == count) break;
  }
  return best;
}

// A step that stays. Numbers: height, begin (held: a fit does not move it).
class Jump final : public Correction {
 public:
  explicit Jump(const LoopRecords& records) : step_s_(records.step_s) {
    const double most = ArcminFromRad(records.twist_range_rad);
    Number("height_arcmin", "arcmin", {-most, most, 1e-6 * most, false, true});
    Number("begin_s", "s", {-records.duration_s, records.duration_s, records.step_s, true, false});
    needs_all_samples = true;
    rule = {.name = "jump in time",
            .sentence = "the angle jumps once and stays: something on the bench was touched or slipped",
            .degrees_of_freedom = 2,
            .trials = 0.5 * SamplesOfRecord(records),
            .local = true,
            .named = false};
  }

  void Add(std::span<const double> v, const LoopGrid& grid, const Eigen::VectorXd&,
           Eigen::VectorXd& total_rad) const override {
    const double height_rad = RadFromArcmin(v[0]);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (grid.time_s[i] >= v[1]) total_rad(static_cast<Eigen::Index>(i)) += height_rad;
    }
  }

  std::vector<std::vector<double>> Starts(const LoopRemainder& remainder) const override {
    std::vector<std::vector<double>> starts;
    for (const std::size_t place : BestJumps(remainder.grid, remainder.residual_rad, 3)) {
      starts.push_back({0.0, remainder.grid.time_s[place] - 1e-3 * step_s_});
    }
    return starts;
  }

 private:
  double step_s_;
};

// A level or a bell in a stretch of time. Numbers: 0 for a level, 1 for a bell; height; centre; full width,
// of the bell at half its height. A fit moves the bell alone.
class Window final : public LoopEffect {
 public:
  explicit Window(const LoopRecords& records) : step_s_(records.step_s), duration_s_(records.duration_s) {
    const double most = ArcminFromRad(records.twist_range_rad);
    numbers = {{0.0, 1.0, 0.0, true, false},
               {-most, most, 1e-6 * most, false, true},
               {0.0, duration_s_, 1e-3 * step_s_, false, false},
               {2.0 * step_s_, 0.4 * duration_s_, 1e-3 * step_s_, false, false}};
    needs_all_samples = true;
    rule = {.name = "window in time",
            .sentence = "the angle is off for a limited time: something on the bench was touched",
            .degrees_of_freedom = 3,
            .trials = 4.0 * SamplesOfRecord(records),
            .local = true,
            .named = false};
  }

  bool IsHeld(std::span<const double> v, std::size_t k) const override {
    return k == 0 || (k > 1 && v[0] < 0.5);
  }

  void Add(std::span<const double> v, const LoopGrid& grid, const Eigen::VectorXd&,
           Eigen::VectorXd& total_rad) const override {
    const double height_rad = RadFromArcmin(v[1]);
    const bool bell = v[0] > 0.5;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double place = 2.0 * (grid.time_s[i] - v[2]) / v[3];
      if (bell) {
        total_rad(static_cast<Eigen::Index>(i)) += height_rad * std::exp(-std::numbers::ln2 * place * place);
      } else if (std::abs(place) <= 1.0) {
        total_rad(static_cast<Eigen::Index>(i)) += height_rad;
      }
    }
  }

  // A level by its two edges; of a bell these are where it has half its height.
  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    const std::vector<double> se = ErrorsOf(covariance);
    const double edge_error_s =
        v[0] > 0.5 ? StandardErrorOf(covariance(2, 2) + 0.25 * covariance(3, 3)) : 0.0;
    return {{v[0] > 0.5 ? "bell_height_arcmin" : "height_arcmin", "arcmin", v[1], se[1]},
            {"begin_s", "s", v[2] - 0.5 * v[3], edge_error_s},
            {"end_s", "s", v[2] + 0.5 * v[3], edge_error_s}};
  }
  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    const double* bell = FindParameter(parameters, "bell_height_arcmin");
    const double begin_s = RequireParameter(rule, parameters, "begin_s");
    const double end_s = RequireParameter(rule, parameters, "end_s");
    return {bell == nullptr ? 0.0 : 1.0,
            bell == nullptr ? RequireParameter(rule, parameters, "height_arcmin") : *bell,
            0.5 * (begin_s + end_s), end_s - begin_s};
  }

  std::vector<std::vector<double>> Starts(const LoopRemainder& remainder) const override {
    const LoopGrid& grid = remainder.grid;
    std::vector<std::vector<double>> starts;
    for (const WindowPeak& peak :
         FindWindows(grid.time_s, remainder.residual_rad, grid.weight, 4.0 * step_s_, 0.2 * duration_s_, 3)) {
      for (const double bell : {0.0, 1.0}) starts.push_back({bell, 0.0, peak.centre, peak.width});
    }
    return starts;
  }

 private:
  double step_s_;
  double duration_s_;
};

}  // namespace

void AppendTimeCorrections(const LoopRecords& records, LoopEffects& effects) {
  effects.push_back(std::make_unique<Jump>(records));
  effects.push_back(std::make_unique<Window>(records));
}

}  // namespace strainwave::analysis::diagnosis
