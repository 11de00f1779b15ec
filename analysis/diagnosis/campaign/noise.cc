// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/campaign/noise.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "analysis/decompositions.h"
#include "analysis/noise_level.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr std::size_t kManyCycles = 30;  // from here on the scatter itself is known to a sixth

std::vector<Index> RowsWithValue(const std::vector<double>& values) {
  std::vector<Index> rows;
  for (std::size_t c = 0; c < values.size(); ++c) {
    if (std::isfinite(values[c])) rows.push_back(static_cast<Index>(c));
  }
  return rows;
}

// Wear, and what follows the temperature or the hour: enough that what is left changes little by itself.
Eigen::MatrixXd SmoothColumns(const CampaignLayout& layout, double run_in_share) {
  const Eigen::MatrixXd wear = WearColumns(layout.load_share, run_in_share);
  const bool temperature = !layout.temperature_degC.empty();
  const bool time = !layout.time_s.empty();
  Eigen::MatrixXd columns(wear.rows(), wear.cols() + (temperature ? 1 : 0) + (time ? 2 : 0));
  columns.leftCols(wear.cols()) = wear;
  Index next = wear.cols();
  for (Index c = 0; c < wear.rows(); ++c) {
    const auto row = static_cast<std::size_t>(c);
    if (temperature) columns(c, next) = layout.temperature_degC[row] - layout.temperature_degC[0];
    if (!time) continue;
    const double angle = kTwoPi * (layout.time_s[row] - layout.time_s[0]) / kDay_s;
    columns(c, columns.cols() - 2) = std::cos(angle);
    columns(c, columns.cols() - 1) = std::sin(angle);
  }
  return columns;
}

// What a series leaves beside these columns, NaN where it has no value.
std::vector<double> LeftBeside(const std::vector<double>& values, const Eigen::MatrixXd& columns) {
  const std::vector<Index> rows = RowsWithValue(values);
  const Eigen::MatrixXd design = columns(rows, Eigen::all);
  Eigen::VectorXd y(static_cast<Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    y(static_cast<Index>(i)) = values[static_cast<std::size_t>(rows[i])];
  }
  const Eigen::VectorXd left = y - design * LeastSquares(design, y);
  std::vector<double> result(values.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    result[static_cast<std::size_t>(rows[i])] = left(static_cast<Index>(i));
  }
  return result;
}

// Differences of neighbouring cycles over √2, so that they scatter like the values; steps count once.
std::vector<double> Differences(const std::vector<double>& values) {
  std::vector<double> differences(values.size(), std::numeric_limits<double>::quiet_NaN());
  std::size_t before = values.size();
  for (std::size_t c = 0; c < values.size(); ++c) {
    if (!std::isfinite(values[c])) continue;
    if (before < c) differences[c] = (values[c] - values[before]) / std::sqrt(2.0);
    before = c;
  }
  return differences;
}

// Standard deviation with what lies beyond three of them held at three: nearly as sharp as the plain one, and
// a step or a spike counts little.
double Scatter(const std::vector<double>& differences) {
  std::vector<double> finite;
  for (const double d : differences) {
    if (std::isfinite(d)) finite.push_back(d);
  }
  double scatter = RobustStandardDeviation(finite);
  for (int round = 0; round < 5 && scatter > 0.0; ++round) {
    double squares = 0.0;
    for (const double d : finite) {
      const double held = std::min(std::abs(d), 3.0 * scatter);
      squares += held * held;
    }
    // 0.995: share of a normal variable's variance that is left.
    scatter = std::sqrt(squares / (0.995 * static_cast<double>(finite.size())));
  }
  return scatter;
}

// A scatter from n neighbours is known to √(3 / 4n) of itself. Where the standard errors of the series, times
// one common factor, are as good, that is taken instead; else part of the way (James & Stein's shrinking, of
// the logarithms). Returns the share of its own scatter that each series keeps.
double ShrinkToStandardErrors(std::span<const double> standard_errors, double cycles,
                              std::vector<double>& scatter) {
  const auto count = static_cast<double>(scatter.size());
  if (count < 4.0) return 1.0;
  std::vector<double> logs;
  double mean = 0.0;
  for (std::size_t s = 0; s < scatter.size(); ++s) {
    if (!(scatter[s] > 0.0) || !(standard_errors[s] > 0.0)) return 1.0;
    logs.push_back(std::log(scatter[s] / standard_errors[s]));
    mean += logs.back() / count;
  }
  double squares = 0.0;
  for (const double log : logs) squares += (log - mean) * (log - mean);
  const double expected = 0.75 / cycles;
  const boost::math::chi_squared by_chance(count - 1.0);
  const bool alike = squares < expected * boost::math::quantile(by_chance, 0.95);
  const double own = alike ? 0.0 : std::max(0.0, 1.0 - (count - 3.0) * expected / squares);
  for (std::size_t s = 0; s < scatter.size(); ++s) {
    scatter[s] = standard_errors[s] * std::exp(mean + own * (logs[s] - mean));
  }
  return own;
}

// Student's tail over the normal one, where one chance in 10⁵ is left.
double TailOfScatter(double own, double cycles) {
  constexpr double kChance = 1e-5;
  // That the standard errors are one common factor off is never certain.
  constexpr double kLeastOwn = 0.5;
  const double share = std::max(own, kLeastOwn);
  const double freedom = std::max(3.0, cycles / (1.5 * share * share));
  const double z = boost::math::quantile(boost::math::complement(boost::math::normal(), 0.5 * kChance));
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::students_t(freedom), z)) / kChance;
}

double ClearCorrelation(const std::vector<double>& a, double a_scatter, const std::vector<double>& b,
                        double b_scatter) {
  constexpr double kClear = 3.5;  // standard errors: a wrong one would scale its series up
  if (!(a_scatter > 0.0) || !(b_scatter > 0.0)) return 0.0;
  double aa = 0.0;
  double bb = 0.0;
  double ab = 0.0;
  double count = 0.0;
  for (std::size_t c = 0; c < a.size(); ++c) {
    if (!std::isfinite(a[c]) || !std::isfinite(b[c])) continue;
    // A step of many series in one cycle is no common scatter.
    const double x = std::clamp(a[c] / a_scatter, -3.0, 3.0);
    const double y = std::clamp(b[c] / b_scatter, -3.0, 3.0);
    aa += x * x;
    bb += y * y;
    ab += x * y;
    count += 1.0;
  }
  if (count < 10.0 || !(aa > 0.0) || !(bb > 0.0)) return 0.0;
  const double r = ab / std::sqrt(aa * bb);
  // Neighbouring differences share a value, which takes a third of the information.
  return std::abs(r) > kClear * std::sqrt(1.5 / count) ? r : 0.0;
}

// Small steps towards independence until the matrix can be inverted with a margin.
Eigen::MatrixXd MadePositive(Eigen::MatrixXd correlation) {
  constexpr double kSmallestEigenvalue = 0.05;
  for (int step = 0; step < 60; ++step) {
    if (SymmetricEigenvalues(correlation).minCoeff() >= kSmallestEigenvalue) break;
    const Eigen::VectorXd diagonal = correlation.diagonal();
    correlation *= 0.95;
    correlation.diagonal() = diagonal;
  }
  return correlation;
}

double BestRunIn(const std::vector<std::vector<double>>& values, std::span<const double> scale,
                 const CampaignLayout& layout) {
  // From about three cycles to where it cannot be told from the trend.
  const double shortest = std::max(0.003, 3.0 / static_cast<double>(layout.cycles()));
  constexpr double kLongest = 0.25;
  double best = shortest;
  double least = std::numeric_limits<double>::infinity();
  for (double share = shortest; share <= kLongest; share *= 1.12) {
    const Eigen::MatrixXd columns = SmoothColumns(layout, share);
    double sum = 0.0;
    for (std::size_t s = 0; s < values.size(); ++s) {
      for (const double left : LeftBeside(values[s], columns)) {
        if (std::isfinite(left)) sum += left * left / (scale[s] * scale[s]);
      }
    }
    if (sum < least) {
      least = sum;
      best = share;
    }
  }
  return best;
}

}  // namespace

double MedianError(std::span<const double> standard_errors) {
  std::vector<double> positive;
  for (const double error : standard_errors) {
    if (std::isfinite(error) && error > 0.0) positive.push_back(error);
  }
  return Median(std::move(positive));
}

CampaignNoise EstimateCampaignNoise(const std::vector<std::vector<double>>& values,
                                    std::span<const double> standard_errors, const CampaignLayout& layout) {
  constexpr double kAnyRunIn = 0.05;  // differences of neighbours hardly see it
  const std::size_t count = values.size();
  CampaignNoise noise;
  std::vector<std::vector<double>> differences(count);
  const Eigen::MatrixXd columns = SmoothColumns(layout, kAnyRunIn);
  double floor_squares = 0.0;
  for (std::size_t s = 0; s < count; ++s) {
    const bool many = RowsWithValue(values[s]).size() >= kManyCycles;
    differences[s] = Differences(many ? LeftBeside(values[s], columns) : values[s]);
    noise.scatter.push_back(Scatter(differences[s]));
  }
  const auto cycles = static_cast<double>(layout.cycles());
  const double own = ShrinkToStandardErrors(standard_errors, cycles, noise.scatter);
  noise.single_tail = TailOfScatter(own, cycles);
  for (std::size_t s = 0; s < count; ++s) {
    const bool many = RowsWithValue(values[s]).size() >= kManyCycles;
    double scale = noise.scatter[s];
    if (!many || !(scale > 0.0)) scale = std::max(scale, standard_errors[s]);
    // A series of a few rounded values: its steps are all the noise there is.
    if (!(scale > 0.0)) scale = EstimateNoise(values[s]).step;
    noise.scale.push_back(scale > 0.0 ? scale : 1.0);
    floor_squares += noise.scatter[s] * noise.scatter[s] / (noise.scale[s] * noise.scale[s]);
  }
  noise.floor = std::sqrt(floor_squares / static_cast<double>(count));
  noise.correlation = Eigen::MatrixXd::Identity(static_cast<Index>(count), static_cast<Index>(count));
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double r = ClearCorrelation(differences[a], noise.scatter[a], differences[b], noise.scatter[b]);
      noise.correlation(static_cast<Index>(a), static_cast<Index>(b)) = r;
      noise.correlation(static_cast<Index>(b), static_cast<Index>(a)) = r;
    }
  }
  noise.correlation = MadePositive(noise.correlation);
  noise.run_in_share = BestRunIn(values, noise.scale, layout);
  return noise;
}

}  // namespace strainwave::analysis::diagnosis
