// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/hysteresis/correction.h"
#include "analysis/diagnosis/hysteresis/jumps.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

double SamplesOfRecord(const LoopRecords& records) {
  return static_cast<double>(records.samples.size()) / static_cast<double>(records.samples.records());
}

// A step that stays. Numbers: height, begin (held: a fit does not move it).
class Jump final : public NuisanceTerm {
 public:
  explicit Jump(const LoopRecords& records) : step_s_(records.step_s) {
    const double most = ArcminFromRad(records.twist_range_rad);
    Number("height_arcmin", "arcmin", {-most, most, 1e-6 * most, false, true});
    Number("begin_s", "s", {-records.duration_s, records.duration_s, records.step_s, true, false});
    needs_all_samples = true;
    rule = {.name = "jump in time",
            .sentence = "the angle jumps once and stays: something on the bench was touched or slipped",
            .parameters = {{"height_arcmin", "arcmin", -most, most, true}},
            .degrees_of_freedom = 2,
            .location_parameters = 1,
            .trials_factor = 0.5 * SamplesOfRecord(records),
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

  std::vector<std::vector<double>> Starts(const LoopResidual& residual) const override {
    std::vector<std::vector<double>> starts;
    for (const std::size_t sample : BestJumps(residual.grid.weight, residual.residual_rad, 3)) {
      starts.push_back({0.0, residual.grid.time_s[sample] - 1e-3 * step_s_});
    }
    return starts;
  }

 private:
  double step_s_;
};

// Widths of windows, as they are searched: those that last are fewer, and are looked for by themselves.
enum class Lasting { kBriefly, kLong };

// A window's two ends moved to where the residual's sum of squares drops most by a level between them.
WindowPeak WithBestEnds(const LoopGrid& grid, std::span<const double> residual, const WindowPeak& window) {
  const std::size_t n = grid.size();
  const RunningSums sums = RunningSumsOf(grid.weight, residual);
  const std::vector<double>& sum = sums.sum;
  const std::vector<double>& weight = sums.weight;
  const auto drop_of = [&](std::size_t first, std::size_t end) {
    const double inside = weight[end] - weight[first];
    const double share = inside / std::max(weight[n], 1e-300);
    if (!(inside > 0.0) || share > 0.9) return 0.0;
    const double raised = sum[end] - sum[first] - sum[n] * share;
    return raised * raised / (inside * (1.0 - share));
  };
  const auto at = [&](double time_s) {
    return static_cast<std::size_t>(std::lower_bound(grid.time_s.begin(), grid.time_s.end(), time_s) -
                                    grid.time_s.begin());
  };
  std::size_t first = at(window.centre - 0.5 * window.width);
  std::size_t end = at(window.centre + 0.5 * window.width);
  for (int round = 0; round < 2; ++round) {
    const std::size_t reach = (end - first) / 2;
    std::size_t best = first;
    for (std::size_t i = first > reach ? first - reach : 0; i + 2 < end && i <= first + reach; ++i) {
      if (drop_of(i, end) > drop_of(best, end)) best = i;
    }
    first = best;
    best = end;
    for (std::size_t i = std::max(end - reach, first + 2); i <= std::min(n, end + reach); ++i) {
      if (drop_of(first, i) > drop_of(first, best)) best = i;
    }
    end = best;
  }
  if (end <= first + 1) return window;
  const double begin_s = grid.time_s[first];
  const double end_s = grid.time_s[end - 1];
  return {0.5 * (begin_s + end_s), end_s - begin_s, drop_of(first, end)};
}

// A level or a bell in a segment of time. Numbers: 0 for a level, 1 for a bell; height; centre; full width,
// of the bell at half its height. A fit moves the bell alone.
class Window final : public LoopEffect {
 public:
  Window(const LoopRecords& records, Lasting lasting)
      : step_s_(records.step_s),
        duration_s_(records.duration_s),
        one_record_(records.samples.records() == 1) {
    // A fiftieth of the record parts the two.
    const double parting_s = std::max(0.02 * duration_s_, 4.0 * step_s_);
    const bool brief = lasting == Lasting::kBriefly;
    narrowest_s_ = brief ? 4.0 * step_s_ : parting_s;
    widest_s_ = brief ? parting_s : 0.2 * duration_s_;
    const double most = ArcminFromRad(records.twist_range_rad);
    numbers = {{0.0, 1.0, 0.0, true, false},
               {-most, most, 1e-6 * most, false, true},
               {0.0, duration_s_, 1e-3 * step_s_, false, false},
               {2.0 * step_s_, 0.4 * duration_s_, 1e-3 * step_s_, false, false}};
    needs_all_samples = true;
    rule = {.name = brief ? "window in time" : "long window in time",
            .sentence = "the angle is off for a limited time: something on the bench was touched",
            .parameters = {{"height_arcmin", "arcmin", -most, most, true},
                           {"bell_height_arcmin", "arcmin", -most, most, true}},
            .degrees_of_freedom = 3,
            .location_parameters = 2,
            // Windows that overlap, in all widths.
            .trials_factor = 12.0 * duration_s_ / narrowest_s_,
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
      const double x = 2.0 * (grid.time_s[i] - v[2]) / v[3];
      if (bell) {
        total_rad(static_cast<Eigen::Index>(i)) += height_rad * Bell(x);
      } else if (std::abs(x) <= 1.0) {
        total_rad(static_cast<Eigen::Index>(i)) += height_rad;
      }
    }
  }

  double LogSearchLocations(std::span<const double> v) const override {
    return LogSearchLocationsOfWidth(v[3], narrowest_s_, widest_s_);
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

  std::vector<std::vector<double>> Starts(const LoopResidual& residual) const override {
    const LoopGrid& grid = residual.grid;
    std::vector<std::vector<double>> starts;
    for (const WindowPeak& peak :
         FindWindows(grid.time_s, residual.residual_rad, grid.weight, narrowest_s_, widest_s_, 3)) {
      const WindowPeak level = one_record_ ? WithBestEnds(grid, residual.residual_rad, peak) : peak;
      starts.push_back({0.0, 0.0, level.centre, level.width + 1e-3 * step_s_});
      starts.push_back({1.0, 0.0, peak.centre, peak.width});
    }
    return starts;
  }

 private:
  double step_s_;
  double duration_s_;
  bool one_record_;  // the grid's times then rise throughout
  double narrowest_s_{};
  double widest_s_{};
};

}  // namespace

void AppendTimeNuisanceTerms(const LoopRecords& records, LoopEffects& effects) {
  effects.push_back(std::make_unique<Jump>(records));
  for (const Lasting lasting : {Lasting::kBriefly, Lasting::kLong}) {
    effects.push_back(std::make_unique<Window>(records, lasting));
  }
}

}  // namespace strainwave::analysis::diagnosis
