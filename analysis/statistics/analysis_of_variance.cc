// SPDX-License-Identifier: Apache-2.0
#include "analysis/statistics/analysis_of_variance.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_f.hpp>

#include "analysis/arguments.h"
#include "analysis/decompositions.h"

namespace strainwave::analysis::statistics {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
using Term = unsigned;  // bit f: factor f takes part

// Effect coding: level l < last has a 1 in column l, the last level −1 in all, so that columns of different
// terms are orthogonal where cells are alike.
Eigen::MatrixXd MainColumns(const Eigen::VectorXi& level, int count) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(level.size(), count - 1);
  for (Eigen::Index i = 0; i < level.size(); ++i) {
    if (level(i) == count - 1) {
      columns.row(i).setConstant(-1.0);
    } else {
      columns(i, level(i)) = 1.0;
    }
  }
  return columns;
}

Eigen::MatrixXd Products(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd columns(a.rows(), a.cols() * b.cols());
  for (Eigen::Index i = 0; i < a.cols(); ++i) {
    for (Eigen::Index j = 0; j < b.cols(); ++j)
      columns.col(i * b.cols() + j) = a.col(i).cwiseProduct(b.col(j));
  }
  return columns;
}

class Models {
 public:
  Models(std::span<const double> values, const Eigen::MatrixXi& levels, const std::vector<int>& counts)
      : centred_(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()))) {
    centred_.array() -= centred_.mean();
    for (Term term = 1; term < Term{1} << counts.size(); ++term) {
      Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(levels.rows(), 1);
      for (std::size_t f = 0; f < counts.size(); ++f) {
        if ((term >> f & 1U) != 0)
          columns = Products(columns, MainColumns(levels.col(static_cast<Eigen::Index>(f)), counts[f]));
      }
      columns_.push_back(std::move(columns));
    }
  }

  struct Fit {
    double residual{};  // sum of squares
    int rank{};
  };
  Fit Of(const std::vector<Term>& terms) const {
    Eigen::Index width = 1;
    for (const Term term : terms) width += columns_[term - 1].cols();
    Eigen::MatrixXd all(centred_.size(), width);
    all.col(0).setOnes();
    Eigen::Index at = 1;
    for (const Term term : terms) {
      all.middleCols(at, columns_[term - 1].cols()) = columns_[term - 1];
      at += columns_[term - 1].cols();
    }
    const Eigen::MatrixXd basis = OrthonormalBasis(all);
    return {(centred_ - basis * (basis.transpose() * centred_)).squaredNorm(),
            static_cast<int>(basis.cols())};
  }
  double total() const { return centred_.squaredNorm(); }

 private:
  Eigen::VectorXd centred_;
  std::vector<Eigen::MatrixXd> columns_;  // by term − 1
};

std::string NameOfTerm(Term term, const std::vector<std::string>& factors) {
  std::vector<std::string> names;
  for (std::size_t f = 0; f < factors.size(); ++f) {
    if ((term >> f & 1U) != 0) names.push_back(factors[f]);
  }
  return fmt::format("{}", fmt::join(names, ":"));
}

struct Cells {
  std::size_t there{};
  std::size_t possible{1};
  std::size_t least{std::numeric_limits<std::size_t>::max()};
  std::size_t most{};
};

Cells CellsOf(const Eigen::MatrixXi& levels, const std::vector<int>& counts) {
  std::map<std::vector<int>, std::size_t> sizes;
  for (Eigen::Index i = 0; i < levels.rows(); ++i) {
    std::vector<int> cell;
    for (Eigen::Index f = 0; f < levels.cols(); ++f) cell.push_back(levels(i, f));
    ++sizes[cell];
  }
  Cells cells;
  for (const int count : counts) cells.possible *= static_cast<std::size_t>(count);
  cells.there = sizes.size();
  for (const auto& [cell, size] : sizes) {
    cells.least = std::min(cells.least, size);
    cells.most = std::max(cells.most, size);
  }
  return cells;
}

// Levels as 0, 1, … in their order.
Eigen::MatrixXi Numbered(const Eigen::MatrixXi& levels, const std::vector<std::string>& factors,
                         std::vector<int>& counts) {
  Eigen::MatrixXi numbered(levels.rows(), levels.cols());
  for (Eigen::Index f = 0; f < levels.cols(); ++f) {
    std::map<int, int> numbers;
    for (Eigen::Index i = 0; i < levels.rows(); ++i) numbers[levels(i, f)] = 0;
    int next = 0;
    for (auto& [level, number] : numbers) number = next++;
    if (next < 2)
      throw std::invalid_argument(
          fmt::format("{} has one level (expected two or more)", factors[static_cast<std::size_t>(f)]));
    counts.push_back(next);
    for (Eigen::Index i = 0; i < levels.rows(); ++i) numbered(i, f) = numbers[levels(i, f)];
  }
  return numbered;
}

bool Contains(Term whole, Term part) { return (whole & part) == part; }

// What a term is told beside: by type II those that do not contain it, by type III all others.
std::vector<Term> Beside(Term term, const std::vector<Term>& terms, SumsOfSquares type) {
  std::vector<Term> beside;
  for (const Term other : terms) {
    if (other == term) continue;
    if (type == SumsOfSquares::kTypeTwo && Contains(other, term)) continue;
    beside.push_back(other);
  }
  return beside;
}

// The non-centrality at which an F as great as this has that chance to be reached or exceeded, downwards.
double NonCentrality(double f, double df, double error_df, double below) {
  const auto chance = [&](double lambda) {
    if (lambda <= 0.0) return boost::math::cdf(boost::math::fisher_f_distribution<>(df, error_df), f);
    return boost::math::cdf(boost::math::non_central_f_distribution<>(df, error_df, lambda), f);
  };
  if (chance(0.0) < below) return 0.0;
  double high = df * f + 10.0;
  while (chance(high) > below && high < 1e7) high *= 2.0;
  double low = 0.0;
  for (int step = 0; step < 80; ++step) {
    const double middle = 0.5 * (low + high);
    (chance(middle) > below ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

std::string_view NameOf(SumsOfSquares type) {
  switch (type) {
    case SumsOfSquares::kBalanced:
      return "balanced";
    case SumsOfSquares::kTypeTwo:
      return "type II";
    case SumsOfSquares::kTypeThree:
      break;
  }
  return "type III";
}

double ChanceOfF(double f, double degrees_of_freedom, double error_degrees_of_freedom) {
  if (!std::isfinite(f)) return f > 0.0 ? 0.0 : kNone;
  const boost::math::fisher_f_distribution<> distribution(degrees_of_freedom, error_degrees_of_freedom);
  return boost::math::cdf(boost::math::complement(distribution, std::max(f, 0.0)));
}

EtaInterval PartialEtaInterval(double f, double degrees_of_freedom, double error_degrees_of_freedom) {
  constexpr double kTail = 0.025;
  // Beyond, the distribution is out of its library's range; such an effect is next to all of the variance.
  constexpr double kMostF = 1e5;
  if (!std::isfinite(f) || f > kMostF) return {kNone, kNone};
  const double n = degrees_of_freedom + error_degrees_of_freedom + 1.0;
  const double low = NonCentrality(f, degrees_of_freedom, error_degrees_of_freedom, 1.0 - kTail);
  const double high = NonCentrality(f, degrees_of_freedom, error_degrees_of_freedom, kTail);
  return {low / (low + n), high / (high + n)};
}

VarianceTable AnalysisOfVariance(std::span<const double> values, const Eigen::MatrixXi& levels,
                                 const std::vector<std::string>& factors, SumsOfSquares type) {
  if (levels.rows() != static_cast<Eigen::Index>(values.size()) ||
      levels.cols() != static_cast<Eigen::Index>(factors.size()) || factors.empty() || values.size() < 3)
    throw std::invalid_argument(
        fmt::format("{} values with {} × {} levels of {} factors (expected 3 values or more, a "
                    "row of levels each)",
                    values.size(), levels.rows(), levels.cols(), factors.size()));
  if (factors.size() > static_cast<std::size_t>(kMostFactors))
    throw std::invalid_argument(
        fmt::format("{} factors (expected {} at most)", factors.size(), kMostFactors));
  RequireFinite("values", values);
  std::vector<int> counts;
  const Eigen::MatrixXi numbered = Numbered(levels, factors, counts);
  const Cells cells = CellsOf(numbered, counts);

  VarianceTable table;
  const bool empty_cell = cells.there < cells.possible;
  table.type = cells.least == cells.most && !empty_cell ? SumsOfSquares::kBalanced : type;
  if (empty_cell) {
    table.type = SumsOfSquares::kTypeTwo;
    table.notes.push_back(fmt::format(
        "{} of {} cells are empty: the full interaction cannot be estimated, and has the degrees of "
        "freedom that the cells leave it; sums of squares are of type II",
        cells.possible - cells.there, cells.possible));
  }
  std::vector<Term> terms;
  for (Term term = 1; term < Term{1} << factors.size(); ++term) terms.push_back(term);
  std::ranges::stable_sort(terms, {}, [](Term term) { return std::popcount(term); });
  if (cells.most == 1 && factors.size() > 1) {
    table.notes.push_back(
        fmt::format("each cell has one value: {} is the error", NameOfTerm(terms.back(), factors)));
    terms.pop_back();
  }
  const Models models(values, numbered, counts);
  const Models::Fit full = models.Of(terms);
  const int error_df = static_cast<int>(values.size()) - full.rank;
  if (error_df < 1)
    throw std::invalid_argument(fmt::format(
        "{} values for {} estimated means leave nothing for the error (expected several values in "
        "a cell)",
        values.size(), full.rank));
  const SumsOfSquares sums = table.type == SumsOfSquares::kBalanced ? SumsOfSquares::kTypeThree : table.type;
  const double total = models.total();
  const double error = full.residual;
  for (const Term term : terms) {
    std::vector<Term> beside = Beside(term, terms, sums);
    const Models::Fit without = models.Of(beside);
    beside.push_back(term);
    const Models::Fit with = models.Of(beside);
    VarianceSource row{.source = NameOfTerm(term, factors),
                       .sum_of_squares = std::max(0.0, without.residual - with.residual),
                       .degrees_of_freedom = with.rank - without.rank};
    row.estimable = row.degrees_of_freedom > 0;
    row.f = row.estimable ? row.sum_of_squares / row.degrees_of_freedom / (error / error_df) : kNone;
    row.p = row.estimable ? ChanceOfF(row.f, row.degrees_of_freedom, error_df) : kNone;
    row.eta_squared = total > 0.0 ? row.sum_of_squares / total : 0.0;
    const double partial = row.sum_of_squares + error;
    row.partial_eta_squared = partial > 0.0 ? row.sum_of_squares / partial : 0.0;
    const EtaInterval interval = row.estimable ? PartialEtaInterval(row.f, row.degrees_of_freedom, error_df)
                                               : EtaInterval{kNone, kNone};
    row.partial_low = interval.low;
    row.partial_high = interval.high;
    if (!row.estimable) table.notes.push_back(row.source + " cannot be told from what the other terms say");
    table.rows.push_back(std::move(row));
  }
  table.rows.push_back({.source = "error",
                        .sum_of_squares = error,
                        .degrees_of_freedom = error_df,
                        .f = kNone,
                        .p = kNone,
                        .eta_squared = total > 0.0 ? error / total : 0.0,
                        .partial_eta_squared = kNone,
                        .partial_low = kNone,
                        .partial_high = kNone});
  table.rows.push_back({.source = "total",
                        .sum_of_squares = total,
                        .degrees_of_freedom = static_cast<int>(values.size()) - 1,
                        .f = kNone,
                        .p = kNone,
                        .eta_squared = 1.0,
                        .partial_eta_squared = kNone,
                        .partial_low = kNone,
                        .partial_high = kNone});
  return table;
}

}  // namespace strainwave::analysis::statistics
