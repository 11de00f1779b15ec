// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/motion/terms.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/model/drive_causes.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::max();
constexpr std::size_t kMostWindows = 3;
constexpr double kUsualEdge = 0.2;     // to begin with
constexpr double kLeastBeside = 0.15;  // of the strongest window: soft edges leave a tenth of theirs

struct Scan {
  std::vector<double> time_s;  // of the rows
  double first_s{};
  double last_s{};
  double narrowest_s{};
  double shortest_s{};  // of a push that is no knock
  double widest_s{};
};

// Windows that stand out of what the nominal model leaves, each beside those before it: one, unless several
// together are nearly all of it.
std::size_t CountWindows(const MotionGrid& grid, const Scan& scan) {
  const Eigen::Map<const Eigen::VectorXd> measured(grid.measured.data(), grid.nominal.rows());
  Eigen::VectorXd residual = grid.BesideNominal(measured);
  const std::vector<double> weights(grid.rows(), 1.0);
  const double noise = RobustStandardDeviation({residual.data(), grid.rows()});
  // Beyond the noise, and how far noise alone may seem to exceed itself.
  const double rows = static_cast<double>(grid.rows());
  const double excess = residual.squaredNorm() - noise * noise * (rows + 2.0 * std::sqrt(2.0 * rows));
  std::vector<Eigen::VectorXd> found;
  double explained = 0.0;
  double strongest = 0.0;
  while (found.size() < kMostWindows) {
    const auto peaks =
        FindWindows(scan.time_s, {residual.data(), grid.rows()}, weights, scan.narrowest_s, scan.widest_s, 1);
    if (peaks.empty()) break;
    Eigen::VectorXd window(residual.size());
    for (std::size_t row = 0; row < grid.rows(); ++row) {
      const double off_s = std::abs(scan.time_s[row] - peaks.front().centre);
      window(static_cast<Eigen::Index>(row)) = off_s < 0.5 * peaks.front().width ? 1.0 : 0.0;
    }
    window = grid.BesideNominal(window);
    for (const Eigen::VectorXd& before : found) window -= before * before.dot(window);
    window.normalize();
    const double height = window.dot(residual);
    const double drop = height * height;
    strongest = std::max(strongest, drop);
    if (drop < 25.0 * noise * noise || drop < kLeastBeside * strongest) break;
    explained += drop;
    residual -= height * window;
    found.push_back(std::move(window));
  }
  return explained > 0.6 * excess ? std::max<std::size_t>(found.size(), 1) : 1;
}

void AddWindows(const SharedGrid& grid, const MotionUnits& units, const Scan& scan, std::size_t windows,
                SeparableModel& model) {
  const double step_s = grid->stretches.front().step_s;
  SeparableTerm term =
      PointTerm(grid, windows,
                [grid, step_s](std::span<const double> shapes, std::size_t column, std::span<double> points) {
                  const double start_s = shapes[2 * column];
                  const double end_s = shapes[2 * column + 1];
                  // Never steeper than the points, lest the edges move by whole steps.
                  const double edge_s = std::max(shapes.back() * (end_s - start_s), step_s);
                  for (std::size_t i = 0; i < points.size(); ++i) {
                    points[i] = model::WindowShape(grid->time_s[i], start_s, end_s, edge_s);
                  }
                });
  for (std::size_t k = 0; k < 2 * windows; ++k) {
    term.shapes.push_back(
        {scan.first_s - scan.narrowest_s, scan.last_s + scan.narrowest_s, 2.0 * grid->row_spacing_s});
  }
  term.shapes.push_back({0.0, 0.5, 0.05});  // share of a window that each of its edges takes
  term.starts = [grid, term, scan, windows](const Remainder& remainder) {
    const std::vector<WindowPeak> peaks = FindWindows(scan.time_s, remainder.residual, remainder.weights,
                                                      windows == 1 ? scan.narrowest_s : scan.shortest_s,
                                                      scan.widest_s, windows == 1 ? 3 : windows);
    if (windows > 1 && peaks.size() < windows) return std::vector<std::vector<double>>{};
    // One start a window, or one of all windows.
    std::vector<std::vector<double>> starts(windows == 1 ? peaks.size() : 1);
    std::vector<std::vector<double>> steps(starts.size());
    for (std::size_t k = 0; k < peaks.size(); ++k) {
      const std::size_t into = windows == 1 ? k : 0;
      for (const double side : {-0.5, 0.5}) {
        // The width is at half the height.
        starts[into].push_back(peaks[k].centre + side * peaks[k].width / (1.0 - kUsualEdge));
        steps[into].push_back(0.2 * peaks[k].width);
      }
    }
    for (std::size_t k = 0; k < starts.size(); ++k) {
      starts[k].push_back(kUsualEdge);
      steps[k].push_back(0.1);
    }
    StartSearch search(*grid, term, remainder);
    for (std::size_t k = 0; k < starts.size(); ++k) starts[k] = search.Polish(starts[k], steps[k]);
    return starts;
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
    const auto error = [&](std::size_t k) {
      const auto i = static_cast<Eigen::Index>(k);
      return StandardErrorOf(covariance(i, i));
    };
    // An edge is where the likelihood is largest, not where its slope says: the variance of a change point is
    // 26 (noise / step)⁴ (Yao, Ann. Statist. 15 (1987) 1321). And between two rows, next to a reversal or a
    // gap, nobody saw where it was.
    const auto edge_error = [&](std::size_t k, double height) {
      const double noise = grid->noise_floor / std::max(std::abs(height), 1e-300);
      const double jump_s = std::sqrt(26.0) * noise * noise * grid->row_spacing_s;
      const auto next = std::ranges::upper_bound(scan.time_s, numbers[k]);
      const bool inside = next != scan.time_s.begin() && next != scan.time_s.end();
      const double unseen_s = inside ? (*next - *(next - 1)) / std::sqrt(12.0) : 0.0;
      return std::hypot(error(k), jump_s, unseen_s);
    };
    std::vector<ParameterValue> values;
    for (std::size_t w = 0; w < windows; ++w) {
      const std::size_t from = windows + 2 * order[w];
      values.push_back({name("start", w, "s"), "s", numbers[from], edge_error(from, numbers[order[w]])});
      values.push_back(
          {name("end", w, "s"), "s", numbers[from + 1], edge_error(from + 1, numbers[order[w]])});
      values.push_back(
          {name("torque", w, units.torque()), units.torque(), numbers[order[w]], error(order[w])});
      values.push_back(
          {name("duration", w, "s"), "s", numbers[from + 1] - numbers[from],
           std::hypot(edge_error(from, numbers[order[w]]), edge_error(from + 1, numbers[order[w]]))});
    }
    values.push_back({"edge_share", "1", numbers.back(), error(numbers.size() - 1)});
    return values;
  };
  term.restore = [windows](std::span<const double> values) {
    std::vector<double> numbers;
    for (std::size_t w = 0; w < windows; ++w) numbers.push_back(values[4 * w + 2]);
    for (std::size_t w = 0; w < windows; ++w) {
      numbers.push_back(values[4 * w]);
      numbers.push_back(values[4 * w + 1]);
    }
    numbers.push_back(values.back());
    return numbers;
  };
  CauseRule rule{
      .name = "external_disturbance",
      .sentence =
          units.linear
              ? "a force from outside for a limited time: something touched, pulled or jammed the axis"
              : "a torque from outside for a limited time: something touched, braked or drove the axis",
      .where = Where::kBench,
      .degrees_of_freedom = static_cast<int>(3 * windows + 1),
      .trials = std::pow(2.0 * (scan.last_s - scan.first_s) / scan.narrowest_s, static_cast<double>(windows)),
      .local = true};
  rule.parameters = {{name("torque", 0, units.torque()), units.torque(), -kUnlimited, kUnlimited, true}};
  for (std::size_t w = 0; w < windows; ++w) {
    // Shorter than that it is a knock at most, and more often a reversal that came out badly.
    rule.parameters.push_back({name("duration", w, "s"), "s", scan.shortest_s, kUnlimited, false});
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
  scan.narrowest_s = 4.0 * grid->row_spacing_s;
  scan.first_s = *first;
  scan.last_s = *last;
  scan.widest_s = 0.4 * (scan.last_s - scan.first_s);
  if (!(scan.widest_s > 2.0 * scan.narrowest_s)) return;
  // Several pushes are one effect; but what looks like several may be one beside something else.
  const std::size_t windows = CountWindows(*grid, scan);
  if (windows > 1) AddWindows(grid, units, scan, windows, model);
  AddWindows(grid, units, scan, 1, model);
}

}  // namespace strainwave::analysis::diagnosis
