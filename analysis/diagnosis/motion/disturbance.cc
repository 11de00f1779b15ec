// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/motion/terms.h"
#include "analysis/diagnosis/motion/usual_effects.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/model/drive_causes.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kLeastShare = 0.001;  // of squares: less is what a formula of something else leaves
constexpr std::size_t kMostWindows = 3;
constexpr double kClearWindow = 25.0;  // noise variances that a window has to take
constexpr double kUsualEdge = 0.2;     // to begin with
constexpr double kLeastBeside = 0.15;  // of the strongest window: soft edges leave a tenth of theirs

struct Scan {
  std::vector<double> time_s;  // of the rows
  double first_s{};
  double last_s{};
  double shortest_s{};  // of a push that is no impact
  double widest_s{};
};

// Windows that stand out of what these columns leave, each beside those before it.
std::size_t CountWindowsBeside(const Eigen::MatrixXd& columns, const MotionGrid& grid, const Scan& scan) {
  const Eigen::MatrixXd basis = OrthonormalBasis(columns);
  const auto beside = [&](const Eigen::VectorXd& column) -> Eigen::VectorXd {
    return column - basis * (basis.transpose() * column);
  };
  Eigen::VectorXd residual =
      beside(Eigen::Map<const Eigen::VectorXd>(grid.measured.data(), grid.nominal.rows()));
  const std::vector<double> weights(grid.rows(), 1.0);
  const double noise = RobustStandardDeviation({residual.data(), grid.rows()});
  std::vector<Eigen::VectorXd> found;
  double strongest = 0.0;
  while (found.size() < kMostWindows) {
    const auto peaks =
        FindWindows(scan.time_s, {residual.data(), grid.rows()}, weights, scan.shortest_s, scan.widest_s, 1);
    if (peaks.empty()) break;
    Eigen::VectorXd window(residual.size());
    for (std::size_t row = 0; row < grid.rows(); ++row) {
      const double off_s = std::abs(scan.time_s[row] - peaks.front().centre);
      window(static_cast<Eigen::Index>(row)) = off_s < 0.5 * peaks.front().width ? 1.0 : 0.0;
    }
    window = beside(window);
    for (const Eigen::VectorXd& before : found) window -= before * before.dot(window);
    window.normalize();
    const double height = window.dot(residual);
    const double drop = height * height;
    strongest = std::max(strongest, drop);
    if (drop < kClearWindow * noise * noise || drop < kLeastBeside * strongest) break;
    residual -= height * window;
    found.push_back(std::move(window));
  }
  return found.size();
}

// Beside the nominal model alone, where long windows in a short record are not taken for a drift, and beside
// the usual effects, where none of these hides them.
std::size_t CountWindows(const MotionGrid& grid, const Scan& scan) {
  const Eigen::MatrixXd usual = UsualEffectsAndLines(grid, StrongestOrders(grid));
  Eigen::MatrixXd known(grid.nominal.rows(), grid.nominal.cols() + usual.cols());
  known << grid.nominal, usual;
  return std::max(
      {CountWindowsBeside(grid.nominal, grid, scan), CountWindowsBeside(known, grid, scan), std::size_t{1}});
}

// Fills a column with a window in time; only what it covers is worked out.
void FillWindow(const MotionGrid& grid, double start_s, double end_s, double edge_s,
                std::vector<double>& points, Eigen::Ref<Eigen::VectorXd> column) {
  column.setZero();
  for (const MotionGrid::Segment& segment : grid.segments) {
    const auto from = grid.time_s.begin() + static_cast<std::ptrdiff_t>(segment.first);
    const auto to = from + static_cast<std::ptrdiff_t>(segment.count);
    const auto first = static_cast<std::size_t>(std::lower_bound(from, to, start_s) - grid.time_s.begin());
    const auto last = static_cast<std::size_t>(std::lower_bound(from, to, end_s) - grid.time_s.begin());
    for (std::size_t i = first; i < last; ++i) {
      points[i] = model::WindowShape(grid.time_s[i], start_s, end_s, edge_s);
    }
    grid.AddProjected(points, first, last, column);
    std::fill(points.begin() + static_cast<std::ptrdiff_t>(first),
              points.begin() + static_cast<std::ptrdiff_t>(last), 0.0);
  }
}

// Nonlinear parameters: start and ln duration of each window, so that none gets shorter than a push is; share
// of a window that each of its edges takes.
void AddWindows(const SharedGrid& grid, const MotionUnits& units, const Scan& scan, std::size_t windows,
                SeparableModel& model) {
  const double step_s = grid->segments.front().step_s;
  SeparableTerm term;
  term.columns = windows;
  term.fill = [grid, step_s, windows](std::span<const double> nonlinear_parameters,
                                      Eigen::Ref<Eigen::MatrixXd> design) {
    std::vector<double> points(grid->time_s.size(), 0.0);
    for (std::size_t w = 0; w < windows; ++w) {
      const double start_s = nonlinear_parameters[2 * w];
      const double duration_s = std::exp(nonlinear_parameters[2 * w + 1]);
      // Never steeper than the points, lest the edges move by whole steps.
      const double edge_s = std::max(nonlinear_parameters.back() * duration_s, step_s);
      FillWindow(*grid, start_s, start_s + duration_s, edge_s, points,
                 design.col(static_cast<Eigen::Index>(w)));
    }
  };
  const double longest_s = scan.last_s - scan.first_s;
  for (std::size_t w = 0; w < windows; ++w) {
    term.nonlinear_parameters.push_back(
        {scan.first_s - scan.shortest_s, scan.last_s, 2.0 * grid->row_spacing_s});
    term.nonlinear_parameters.push_back({std::log(scan.shortest_s), std::log(longest_s), 0.1});
  }
  term.nonlinear_parameters.push_back({0.0, 0.5, 0.05, true});
  term.starts = [grid, term, scan, windows](const WeightedResidual& residual) {
    const std::vector<WindowPeak> peaks =
        FindWindows(scan.time_s, residual.values, residual.weights, scan.shortest_s, scan.widest_s,
                    windows == 1 ? 3 : windows);
    if (windows > 1 && peaks.size() < windows) return std::vector<std::vector<double>>{};
    // One start a window, or one of all windows.
    std::vector<std::vector<double>> starts(windows == 1 ? peaks.size() : 1);
    std::vector<std::vector<double>> steps(starts.size());
    for (std::size_t k = 0; k < peaks.size(); ++k) {
      const std::size_t into = windows == 1 ? k : 0;
      // The width is at half the height.
      const double duration_s = std::max(peaks[k].width / (1.0 - kUsualEdge), 1.1 * scan.shortest_s);
      const double start_s = peaks[k].centre - 0.5 * duration_s;
      starts[into].push_back(
          std::clamp(start_s, term.nonlinear_parameters[0].low, term.nonlinear_parameters[0].high));
      starts[into].push_back(std::min(std::log(duration_s), term.nonlinear_parameters[1].high));
      steps[into].push_back(0.2 * peaks[k].width);
      steps[into].push_back(0.2);
    }
    for (std::size_t k = 0; k < starts.size(); ++k) {
      starts[k].push_back(kUsualEdge);
      steps[k].push_back(0.1);
    }
    StartSearch search(*grid, term, residual);
    for (std::size_t k = 0; k < starts.size(); ++k) starts[k] = search.Polish(starts[k], steps[k]);
    return starts;
  };
  term.log_search_locations = [scan, windows](std::span<const double> nonlinear_parameters) {
    double sum = 0.0;
    for (std::size_t w = 0; w < windows; ++w)
      sum += LogSearchLocationsOfWidth(std::exp(nonlinear_parameters[2 * w + 1]), scan.shortest_s,
                                       scan.widest_s);
    return sum;
  };
  // Reported in the order of strength.
  const auto name = [](const char* what, std::size_t window, const std::string& unit) {
    return window == 0 ? fmt::format("{}_{}", what, unit) : fmt::format("{}_{}_{}", what, window + 1, unit);
  };
  term.describe = [=](std::span<const double> numbers, const Eigen::MatrixXd& covariance) {
    std::vector<std::size_t> order(windows);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return std::abs(numbers[a]) > std::abs(numbers[b]); });
    const auto at = [&](std::size_t k) { return static_cast<Eigen::Index>(k); };
    const auto error = [&](std::size_t k) { return StandardErrorOf(covariance(at(k), at(k))); };
    // An edge is where the likelihood is largest, not where its slope says: the variance of a change point is
    // 26 (noise / step)⁴ (Yao, Ann. Statist. 15 (1987) 1321). And between two rows, next to a reversal or a
    // gap, nobody saw where it was.
    const auto edge_error = [&](double edge_s, double slope_error_s, double height) {
      const double noise = grid->noise_floor / std::max(std::abs(height), 1e-300);
      const double jump_s = std::sqrt(26.0) * noise * noise * grid->row_spacing_s;
      const auto next = std::ranges::upper_bound(scan.time_s, edge_s);
      const bool inside = next != scan.time_s.begin() && next != scan.time_s.end();
      const double unseen_s = inside ? (*next - *(next - 1)) / std::sqrt(12.0) : 0.0;
      return std::hypot(slope_error_s, jump_s, unseen_s);
    };
    std::vector<ParameterValue> values;
    for (std::size_t w = 0; w < windows; ++w) {
      const std::size_t from = windows + 2 * order[w];
      const double height = numbers[order[w]];
      const double start_s = numbers[from];
      const double duration_s = std::exp(numbers[from + 1]);
      const double end_s = start_s + duration_s;
      const double end_error_s = StandardErrorOf(
          covariance(at(from), at(from)) + duration_s * duration_s * covariance(at(from + 1), at(from + 1)) +
          2.0 * duration_s * covariance(at(from), at(from + 1)));
      const double start_known_s = edge_error(start_s, error(from), height);
      const double end_known_s = edge_error(end_s, end_error_s, height);
      values.push_back({name("start", w, "s"), "s", start_s, start_known_s});
      values.push_back({name("end", w, "s"), "s", end_s, end_known_s});
      values.push_back({name("torque", w, units.torque()), units.torque(), height, error(order[w])});
      values.push_back({name("duration", w, "s"), "s", duration_s, std::hypot(start_known_s, end_known_s)});
    }
    values.push_back({"edge_share", "1", numbers.back(), error(numbers.size() - 1)});
    return values;
  };
  term.restore = [windows](std::span<const double> values) {
    std::vector<double> numbers;
    for (std::size_t w = 0; w < windows; ++w) numbers.push_back(values[4 * w + 2]);
    for (std::size_t w = 0; w < windows; ++w) {
      numbers.push_back(values[4 * w]);
      numbers.push_back(std::log(std::max(values[4 * w + 1] - values[4 * w], 1e-9)));
    }
    numbers.push_back(values.back());
    return numbers;
  };
  CauseRule rule{
      .name = "external_disturbance",
      .what_to_do = "look up what happened on the bench at the times named, and record again",
      .sentence =
          units.linear
              ? "a force from outside for a limited time: something touched, pulled or jammed the axis"
              : "a torque from outside for a limited time: something touched, braked or drove the axis",
      .where = Where::kBench,
      .degrees_of_freedom = static_cast<int>(3 * windows + 1),
      // Locations of the shortest window, each half over the next, whatever the order of several; where
      // exactly and how long is fitted.
      .trials_factor = std::pow(2.0 * longest_s / scan.shortest_s, static_cast<double>(windows)) /
                       std::tgamma(static_cast<double>(windows) + 1.0),
      .least_share = kLeastShare,
      .local = true};
  rule.parameters = {{name("torque", 0, units.torque()), units.torque(), -kUnlimited, kUnlimited, true}};
  for (std::size_t w = 0; w < windows; ++w) {
    // Shorter than that it is an impact at most, and more often a reversal that came out badly.
    rule.parameters.push_back({name("duration", w, "s"), "s", 1.02 * scan.shortest_s, kUnlimited, false});
  }
  model.causes.push_back(std::move(term));
  model.rules.push_back(std::move(rule));
}

}  // namespace

void AddDisturbanceCause(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model) {
  Scan scan;
  for (std::size_t row = 0; row < grid->rows(); ++row) scan.time_s.push_back(grid->RowTime_s(row));
  const auto [first, last] = std::minmax_element(scan.time_s.begin(), scan.time_s.end());
  scan.shortest_s = std::max(0.03, 8.0 * grid->row_spacing_s);
  scan.first_s = *first;
  scan.last_s = *last;
  scan.widest_s = 0.4 * (scan.last_s - scan.first_s);
  if (!(scan.widest_s > scan.shortest_s)) return;
  // Several pushes are one effect; but what looks like several may be fewer beside something else.
  for (std::size_t windows = CountWindows(*grid, scan); windows > 0; --windows) {
    AddWindows(grid, units, scan, windows, model);
  }
}

}  // namespace strainwave::analysis::diagnosis
