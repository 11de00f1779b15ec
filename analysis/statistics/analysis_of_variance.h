// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace strainwave::analysis::statistics {

/// One row of a table of the analysis of variance.
struct VarianceSource {
  std::string source;  // "hd", "hd:tb", "error", "total"
  double sum_of_squares{};
  int degrees_of_freedom{};
  double f{};  // of error and total: NaN, as p and what follows
  double p{};
  double eta_squared{};          // share of the total sum of squares
  double partial_eta_squared{};  // over the sum of itself and the error
  double partial_low{};          // its 95 % interval
  double partial_high{};
  bool estimable{true};  // false: no degree of freedom is left for it
};

/// Which sums of squares: of a balanced table all are the same.
enum class SumsOfSquares {
  kBalanced,
  kTypeTwo,   // each term after all terms that do not contain it
  kTypeThree  // each term after all others
};
std::string_view NameOf(SumsOfSquares type);

struct VarianceTable {
  std::vector<VarianceSource> rows;  // main effects, interactions, error, total
  SumsOfSquares type{};
  std::vector<std::string> notes;  // of cells that are empty, terms that were pooled
};

/// Analysis of variance of a value by one factor or several with all their interactions, of up to
/// `kMostFactors`; where every cell has one value alone the highest interaction is the error.
///
/// In a table with an empty cell a full interaction cannot be estimated, and type III has no meaning: type II
/// is taken then, and the interaction has the degrees of freedom that the cells leave it.
///
/// @param values  n.
/// @param levels  n × factors: the number of each row's level of each factor.
/// @param factors  names.
/// @param type  of an unbalanced table without an empty cell.
/// @throws std::invalid_argument if sizes differ, a factor has one level, a value is not finite, or nothing
///   is left for the error.
///
/// Source: docs/sources.md#fox-2015, chapter 8 (sums of squares); the interval of η² from those of the
/// non-central F distribution, docs/sources.md#smithson-2001.
VarianceTable AnalysisOfVariance(std::span<const double> values, const Eigen::MatrixXi& levels,
                                 const std::vector<std::string>& factors,
                                 SumsOfSquares type = SumsOfSquares::kTypeThree);

inline constexpr int kMostFactors = 6;

/// The chance of an F at least as great, of that many degrees of freedom.
double ChanceOfF(double f, double degrees_of_freedom, double error_degrees_of_freedom);

/// The 95 % interval of the partial η² behind an F.
struct EtaInterval {
  double low{};
  double high{};
};
EtaInterval PartialEtaInterval(double f, double degrees_of_freedom, double error_degrees_of_freedom);

}  // namespace strainwave::analysis::statistics
