// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/campaign/causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr double kEdge = 3.0;  // cycles that a level needs to be one

NonlinearParameterRange RowRange(const CampaignLayout& layout) {
  return {kEdge, static_cast<double>(layout.cycles()) - kEdge, 1.0};
}

std::vector<std::vector<double>> Rows(const NonlinearParameterRange& range, double stride) {
  std::vector<std::vector<double>> rows;
  for (double row = range.low; row <= range.high; row += stride) rows.push_back({row});
  return rows;
}

// From the whole row on: a shape without a derivative, which the search alone moves.
void FillStep(double row, Eigen::MatrixXd& course, Index column) {
  const auto from = static_cast<Index>(std::lround(row));
  for (Index c = 0; c < course.rows(); ++c) course(c, column) = c >= from ? 1.0 : 0.0;
}

// The location of a step is known the better the larger it is beside the scatter of a cycle. For a small step
// the error of the best location has variance 26 (scatter / step)⁴ (Yao, Ann. Statist. 15 (1987) 1321); a
// large one is known to the cycle.
double StepPositionError(const CampaignLayout& layout, const SeriesChoice& choice,
                         std::span<const double> sizes, double row) {
  constexpr double kWithinACycle = 0.3;
  const auto at =
      static_cast<std::size_t>(std::clamp(std::lround(row), 0L, static_cast<long>(layout.cycles()) - 1));
  double square = 0.0;
  for (std::size_t i = 0; i < layout.cycle_of.size(); ++i) {
    if (layout.cycle_of[i] != at) continue;
    double mixed = 0.0;
    for (std::size_t k = 0; k < choice.series.size(); ++k) {
      mixed += layout.mixing(static_cast<Index>(i), static_cast<Index>(choice.series[k])) * sizes[k];
    }
    square += mixed * mixed;
  }
  const double spread = std::sqrt(26.0) / std::max(square, 1e-6);
  return std::min(std::hypot(kWithinACycle, spread), 0.5 * static_cast<double>(layout.cycles()));
}

}  // namespace

void AddStepChange(const LayoutPointer& layout, SeparableModel& model) {
  const SeriesNumber size{.what = "step", .per = "", .unit_per = "", .factor = 1.0};
  const NonlinearParameterRange range = RowRange(*layout);
  if (range.high <= range.low) return;
  for (const SeriesChoice& choice : ChoicesOf(*layout)) {
    SeparableTerm term = SeriesTerm(
        layout, choice, 1, [](std::span<const double> nonlinear_parameters, Eigen::MatrixXd& course) {
          FillStep(nonlinear_parameters[0], course, 0);
        });
    term.nonlinear_parameters = {range};
    DescribeSeries(term, layout, choice, {size}, {{"cycle", "1", 1.0, true}});
    term.describe = [describe = term.describe, layout, choice](std::span<const double> numbers,
                                                               const Eigen::MatrixXd& covariance) {
      std::vector<ParameterValue> values = describe(numbers, covariance);
      values.back().value = layout->CycleAtRow(std::round(numbers[choice.series.size()]));
      values.back().standard_error =
          StepPositionError(*layout, choice, numbers, numbers[choice.series.size()]);
      return values;
    };
    term.starts = [layout, range, term](const WeightedResidual& residual) {
      const double stride = std::max(1.0, std::floor(static_cast<double>(layout->cycles()) / 100.0));
      auto rows = BestCandidates(*layout, term, residual, Rows(range, stride), 2);
      if (stride > 1.0) {
        std::vector<std::vector<double>> fine;
        for (const auto& row : rows) {
          const NonlinearParameterRange near{std::max(range.low, row[0] - stride),
                                             std::min(range.high, row[0] + stride), 1.0};
          for (const auto& candidate : Rows(near, 1.0)) fine.push_back(candidate);
        }
        rows = BestCandidates(*layout, term, residual, fine, 2);
      }
      return rows;
    };
    CauseRule rule{
        .name = "step_change",
        .what_to_do = "read the journal and the notes at this cycle; inspect teeth, flexspline and mounts",
        .sentence = "the level" + choice.Suffix(*layout) +
                    " shifts from one cycle to the next and stays: a tooth or the flexspline gave way, "
                    "or something on the bench was touched",
        .where = Where::kUndecided,
        .effect = "E23",
        .degrees_of_freedom = static_cast<int>(choice.series.size()) + 1,
        .trials_factor = choice.TrialsFactor(*layout, range.high - range.low),
        .to_settle =
            "# repeat the measurement, and measure the bench alone with the rigid blank: a "
            "shift that the blank shows, too, is the bench's\n"
            "- kind: blank_test\n  peak_torque: 34 Nm\n"};
    AddSizeRules(*layout, choice, size, rule);
    rule.parameters.push_back({"cycle", "1", -kAnySize, kAnySize, false});
    model.causes.push_back(std::move(term));
    model.rules.push_back(std::move(rule));
  }
}

void AddSlopeChange(const LayoutPointer& layout, SeparableModel& model) {
  const SeriesNumber size{.what = "rate_change",
                          .per = "per_1000h",
                          .unit_per = "/(1000 h)",
                          .factor = 3.6e6 / layout->load_span_s};
  const double cycles = static_cast<double>(layout->cycles());
  const NonlinearParameterRange range{0.08 * cycles, 0.92 * cycles, 0.02 * cycles};
  for (const SeriesChoice& choice : ChoicesOf(*layout)) {
    SeparableTerm term = SeriesTerm(
        layout, choice, 1, [layout](std::span<const double> nonlinear_parameters, Eigen::MatrixXd& course) {
          const double from = layout->LoadShareAt(nonlinear_parameters[0]);
          for (Index c = 0; c < course.rows(); ++c) {
            course(c, 0) = std::max(0.0, layout->load_share[static_cast<std::size_t>(c)] - from);
          }
        });
    term.nonlinear_parameters = {range};
    DescribeSeries(term, layout, choice, {size}, {{"cycle", "1", 1.0, true}});
    term.starts = [layout, range, term, cycles](const WeightedResidual& residual) {
      return BestCandidates(*layout, term, residual, Rows(range, 0.03 * cycles), 2);
    };
    CauseRule rule{
        .name = "slope_change",
        .what_to_do = "read what ran since this cycle; look at the lubricant, and look for a crack",
        .sentence = "from one cycle on the wear" + choice.Suffix(*layout) +
                    " goes on at another rate: the lubricant is spent, a crack grows, or the load changed",
        .where = Where::kUnit,
        .effect = "E23",
        .degrees_of_freedom = static_cast<int>(choice.series.size()) + 1,
        .trials_factor = choice.TrialsFactor(*layout, 6.0),
        .to_settle = ""};
    AddSizeRules(*layout, choice, size, rule);
    rule.parameters.push_back({"cycle", "1", -kAnySize, kAnySize, false});
    model.causes.push_back(std::move(term));
    model.rules.push_back(std::move(rule));
  }
}

void AddDailyTemperature(const LayoutPointer& layout, SeparableModel& model) {
  constexpr double kLeastSpan_K = 0.5;
  const bool measured = SpanOf(layout->temperature_degC) > kLeastSpan_K;
  if (!measured) {
    if (layout->time_s.empty() || SpanOf(layout->time_s) < 2.0 * kDay_s) return;
    // At least three cycles a day, or the day folds onto something slower.
    if (SpanOf(layout->time_s) / static_cast<double>(layout->cycles() - 1) > kDay_s / 3.0) return;
  }
  const SeriesNumber size{.what = measured ? "" : "amplitude",
                          .per = measured ? "per_K" : "",
                          .unit_per = measured ? "/K" : "",
                          .factor = 1.0};
  for (const SeriesChoice& choice : ChoicesOf(*layout)) {
    CauseRule rule{
        .name = "daily_temperature",
        .what_to_do =
            "judge trends by the extended model, which takes the temperature out, or keep the hall's "
            "temperature",
        .sentence = std::string("the result") + choice.Suffix(*layout) +
                    (measured ? " follows the temperature at the measurement"
                              : " swings with a period of one day, as the temperature of a hall does") +
                    ": the gear's own stiffness and friction, or the bench and its sensors",
        .where = Where::kUndecided,
        .effect = "E10",
        .degrees_of_freedom = static_cast<int>(choice.series.size()) * (measured ? 1 : 2),
        .trials_factor = choice.TrialsFactor(*layout, 1.0),
        .to_settle =
            "# measure the bench alone with the rigid blank at two temperatures: what the blank "
            "shows is the bench's\n- kind: blank_test\n  peak_torque: 34 Nm\n"};
    SeparableTerm term;
    if (measured) {
      const double mean = Eigen::Map<const Eigen::VectorXd>(layout->temperature_degC.data(),
                                                            static_cast<Index>(layout->cycles()))
                              .mean();
      term = SeriesTerm(layout, choice, 1, [layout, mean](std::span<const double>, Eigen::MatrixXd& course) {
        for (Index c = 0; c < course.rows(); ++c) {
          course(c, 0) = layout->temperature_degC[static_cast<std::size_t>(c)] - mean;
        }
      });
      DescribeSeries(term, layout, choice, {size}, {});
    } else {
      term = SeriesTerm(layout, choice, 2, [layout](std::span<const double>, Eigen::MatrixXd& course) {
        for (Index c = 0; c < course.rows(); ++c) {
          const double angle = kTwoPi * layout->time_s[static_cast<std::size_t>(c)] / kDay_s;
          course(c, 0) = std::cos(angle);
          course(c, 1) = std::sin(angle);
        }
      });
      DescribeSeriesAsHarmonic(term, layout, choice);
    }
    AddSizeRules(*layout, choice, size, rule);
    model.causes.push_back(std::move(term));
    model.rules.push_back(std::move(rule));
  }
}

void AddSensorReplaced(const LayoutPointer& layout, SeparableModel& model) {
  constexpr std::size_t kMost = 6;
  std::vector<std::size_t> rows;
  for (std::size_t c = 1; c < layout->sensor_serials.size(); ++c) {
    const bool changed = layout->sensor_serials[c] != layout->sensor_serials[c - 1] &&
                         !layout->sensor_serials[c].empty() && !layout->sensor_serials[c - 1].empty();
    const bool inside = static_cast<double>(c) >= kEdge && static_cast<double>(c) <= RowRange(*layout).high;
    if (changed && inside && rows.size() < kMost) rows.push_back(c);
  }
  for (const std::size_t row : rows) {
    const std::string per =
        rows.size() > 1 ? fmt::format("from_cycle_{:.0f}", layout->cycle[row]) : std::string{};
    const SeriesNumber size{.what = "step", .per = per, .unit_per = "", .factor = 1.0};
    for (const SeriesChoice& choice : ChoicesOf(*layout)) {
      SeparableTerm term =
          SeriesTerm(layout, choice, 1, [row](std::span<const double>, Eigen::MatrixXd& course) {
            FillStep(static_cast<double>(row), course, 0);
          });
      DescribeSeries(term, layout, choice, {size}, {});
      CauseRule rule{
          .name = "sensor_replaced",
          .what_to_do =
              "calibrate the new sensor against the old one, and judge trends within one sensor's cycles",
          .sentence = fmt::format("the level{} shifts at cycle {:.0f}, where the sensors change from {} "
                                  "to {}: a calibration or a mounting differs",
                                  choice.Suffix(*layout), layout->cycle[row], layout->sensor_serials[row - 1],
                                  layout->sensor_serials[row]),
          .where = Where::kBench,
          .effect = "",
          .degrees_of_freedom = static_cast<int>(choice.series.size()),
          .trials_factor = choice.TrialsFactor(*layout, 1.0),
          .to_settle =
              "# calibrate both sensors against one reference, or measure the blank with each\n"
              "- kind: blank_test\n  peak_torque: 34 Nm\n"};
      AddSizeRules(*layout, choice, size, rule);
      model.causes.push_back(std::move(term));
      model.rules.push_back(std::move(rule));
    }
  }
}

}  // namespace strainwave::analysis::diagnosis
