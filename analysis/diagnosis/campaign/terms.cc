// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/campaign/terms.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

}  // namespace

std::string SeriesChoice::Suffix(const CampaignLayout& layout) const {
  return single ? " of " + layout.series[series.front()].full : std::string{};
}

double SeriesChoice::TrialsFactor(const CampaignLayout& layout, double search_locations) const {
  return search_locations * (single ? layout.single_tail : 1.0);
}

std::vector<SeriesChoice> ChoicesOf(const CampaignLayout& layout) {
  std::vector<SeriesChoice> choices;
  const std::size_t count = layout.series.size();
  if (count > 1) {
    SeriesChoice all{std::vector<std::size_t>(count), false};
    std::iota(all.series.begin(), all.series.end(), std::size_t{0});
    choices.push_back(std::move(all));
  }
  for (std::size_t s = 0; s < count; ++s) {
    choices.push_back({{s}, true});
  }
  return choices;
}

void AddSizeRules(const CampaignLayout& layout, const SeriesChoice& choice, const SeriesNumber& number,
                  CauseRule& rule) {
  for (const std::size_t s : choice.series) {
    rule.parameters.push_back({layout.series[s].Parameter(number.what, number.per),
                               layout.series[s].unit + number.unit_per, -kAnySize, kAnySize, choice.single});
  }
}

SeparableTerm SeriesTerm(const LayoutPointer& layout, const SeriesChoice& choice, std::size_t courses,
                         CourseFill fill) {
  SeparableTerm term;
  term.columns = courses * choice.series.size();
  term.fill = [layout, series = choice.series, courses, fill = std::move(fill)](
                  std::span<const double> nonlinear_parameters, Eigen::Ref<Eigen::MatrixXd> design) {
    Eigen::MatrixXd course(static_cast<Index>(layout->cycles()), static_cast<Index>(courses));
    fill(nonlinear_parameters, course);
    Index column = 0;
    for (const std::size_t s : series) {
      for (Index k = 0; k < course.cols(); ++k, ++column) {
        for (Index i = 0; i < design.rows(); ++i) {
          design(i, column) = layout->mixing(i, static_cast<Index>(s)) *
                              course(static_cast<Index>(layout->cycle_of[static_cast<std::size_t>(i)]), k);
        }
      }
    }
  };
  return term;
}

void DescribeSeries(SeparableTerm& term, const LayoutPointer& layout, const SeriesChoice& choice,
                    std::vector<SeriesNumber> numbers,
                    std::vector<NonlinearParameterNumber> nonlinear_parameters) {
  struct Column {
    std::string name;
    std::string unit;
    double factor;
  };
  std::vector<Column> columns;
  for (const std::size_t s : choice.series) {
    for (const SeriesNumber& number : numbers) {
      columns.push_back({layout->series[s].Parameter(number.what, number.per),
                         layout->series[s].unit + number.unit_per, number.factor * layout->scale[s]});
    }
  }
  term.describe = [layout, columns, nonlinear_parameters](std::span<const double> values,
                                                          const Eigen::MatrixXd& covariance) {
    std::vector<ParameterValue> described;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      described.push_back({columns[i].name, columns[i].unit, values[i] * columns[i].factor,
                           StandardErrorOf(covariance(static_cast<Index>(i), static_cast<Index>(i))) *
                               std::abs(columns[i].factor)});
    }
    for (std::size_t i = 0; i < nonlinear_parameters.size(); ++i) {
      const double value = values[columns.size() + i];
      const auto row = static_cast<Index>(columns.size() + i);
      const double error = StandardErrorOf(covariance(row, row));
      described.push_back(
          {nonlinear_parameters[i].name, nonlinear_parameters[i].unit,
           nonlinear_parameters[i].cycle ? layout->CycleAtRow(value) : value * nonlinear_parameters[i].factor,
           error * nonlinear_parameters[i].factor});
    }
    return described;
  };
  term.restore = [layout, columns, nonlinear_parameters](std::span<const double> values) {
    std::vector<double> restored;
    for (std::size_t i = 0; i < columns.size(); ++i) restored.push_back(values[i] / columns[i].factor);
    for (std::size_t i = 0; i < nonlinear_parameters.size(); ++i) {
      const double value = values[columns.size() + i];
      restored.push_back(nonlinear_parameters[i].cycle ? layout->RowOfCycle(value)
                                                       : value / nonlinear_parameters[i].factor);
    }
    return restored;
  };
}

void DescribeSeriesAsHarmonic(SeparableTerm& term, const LayoutPointer& layout, const SeriesChoice& choice) {
  const std::vector<std::size_t> series = choice.series;
  term.describe = [layout, series](std::span<const double> values, const Eigen::MatrixXd& covariance) {
    std::vector<ParameterValue> described;
    for (std::size_t i = 0; i < series.size(); ++i) {
      const SeriesName& name = layout->series[series[i]];
      const auto first = static_cast<Index>(2 * i);
      const Eigen::Vector2d pair(values[2 * i], values[2 * i + 1]);
      const Eigen::Matrix2d block = covariance.block<2, 2>(first, first);
      const double amplitude = pair.norm();
      const Eigen::Vector2d along =
          amplitude > 0.0 ? Eigen::Vector2d(pair / amplitude) : Eigen::Vector2d(1.0, 0.0);
      const Eigen::Vector2d across(-along(1), along(0));
      const double scale = layout->scale[series[i]];
      described.push_back({name.Parameter("amplitude", ""), name.unit, amplitude * scale,
                           StandardErrorOf(along.dot(block * along)) * scale});
      const double turn = StandardErrorOf(across.dot(block * across)) / std::max(amplitude, 1e-300);
      described.push_back({"phase_" + name.stem + "_deg", "deg", DegFromRad(std::atan2(pair(1), pair(0))),
                           DegFromRad(std::min(turn, kPi))});
    }
    return described;
  };
  term.restore = [layout, series](std::span<const double> values) {
    std::vector<double> restored;
    for (std::size_t i = 0; i < series.size(); ++i) {
      const double amplitude = values[2 * i] / layout->scale[series[i]];
      const double phase = RadFromDeg(values[2 * i + 1]);
      restored.push_back(amplitude * std::cos(phase));
      restored.push_back(amplitude * std::sin(phase));
    }
    return restored;
  };
}

std::vector<std::vector<double>> BestCandidates(const CampaignLayout& layout, const SeparableTerm& term,
                                                const WeightedResidual& residual,
                                                const std::vector<std::vector<double>>& candidates,
                                                std::size_t count) {
  const auto n = static_cast<Index>(layout.measured.size());
  const Eigen::VectorXd root_weight =
      Eigen::Map<const Eigen::VectorXd>(residual.weights.data(), n).cwiseSqrt();
  Eigen::VectorXd weighted =
      root_weight.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(residual.values.data(), n));
  // Every mixture has its own wear model, so that one mixture's columns are enough to project on.
  const Eigen::MatrixXd wear = WearColumns(layout.load_share, layout.run_in_share);
  std::vector<Eigen::MatrixXd> bases;
  for (std::size_t s = 0; s < layout.segments.size(); ++s) {
    const auto first = static_cast<Index>(layout.segments[s]);
    const Index last = s + 1 < layout.segments.size() ? static_cast<Index>(layout.segments[s + 1]) : n;
    Eigen::MatrixXd columns(last - first, wear.cols());
    for (Index i = first; i < last; ++i) {
      columns.row(i - first) =
          root_weight(i) * wear.row(static_cast<Index>(layout.cycle_of[static_cast<std::size_t>(i)]));
    }
    bases.push_back(OrthonormalBasis(columns));
    auto part = weighted.segment(first, last - first);
    part -= bases.back() * (bases.back().transpose() * part).eval();
  }
  std::vector<std::pair<double, std::size_t>> drops;
  Eigen::MatrixXd design(n, static_cast<Index>(term.columns));
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    term.fill(candidates[c], design);
    design = root_weight.asDiagonal() * design;
    const Eigen::VectorXd right = design.transpose() * weighted;
    Eigen::MatrixXd gram = design.transpose() * design;
    for (std::size_t s = 0; s < bases.size(); ++s) {
      const Eigen::MatrixXd along =
          bases[s].transpose() * design.middleRows(static_cast<Index>(layout.segments[s]), bases[s].rows());
      gram -= along.transpose() * along;
    }
    drops.emplace_back(-right.dot(ShortestLeastSquares(gram, right).col(0)), c);
  }
  std::sort(drops.begin(), drops.end());
  std::vector<std::vector<double>> best;
  for (std::size_t i = 0; i < std::min(count, drops.size()); ++i) {
    best.push_back(candidates[drops[i].second]);
  }
  return best;
}

}  // namespace strainwave::analysis::diagnosis
