// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "analysis/diagnosis/motion/grid.h"
#include "analysis/diagnosis/separable_study.h"

namespace strainwave::analysis::diagnosis {

/// Terms outlive the function that makes them and are copied with their study: they own the grid together.
using SharedGrid = std::shared_ptr<const MotionGrid>;

/// Words for a rotary axis, or for a linear one.
struct MotionUnits {
  bool linear{};
  std::string torque() const { return linear ? "N" : "Nm"; }
  std::string inertia() const { return linear ? "kg" : "kg m²"; }
  std::string viscous() const { return linear ? "Ns/m" : "Nms/rad"; }
  std::string speed() const { return linear ? "m/s" : "rad/s"; }
  std::string position() const { return linear ? "m" : "rad"; }
  std::string inertia_name() const { return linear ? "mass_kg" : "inertia_kgm2"; }
  std::string viscous_suffix() const { return linear ? "Ns_per_m" : "Nms_per_rad"; }
  std::string speed_suffix() const { return linear ? "m_per_s" : "rad_per_s"; }
};

/// The nominal model: inertia, viscous and Coulomb friction, an offset for each record.
void AddNominalMotion(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model);

/// Causes with their rules, and warnings for those that the record did not excite and that are left out.
void AddFrictionCauses(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model);
void AddLoadCause(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model);
void AddPositionCauses(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model);
void AddDynamicCauses(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model);
void AddDisturbanceCause(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model);
/// Nuisance terms, which have no physical cause.
void AddMotionNuisanceTerms(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model);

/// A term whose columns are evaluated at the points and low-passed: `column_at(nonlinear_parameters, column,
/// points)` fills one.
template <typename ColumnAt>
SeparableTerm PointTerm(SharedGrid grid, std::size_t columns, ColumnAt column_at) {
  SeparableTerm term;
  term.columns = columns;
  term.fill = [grid = std::move(grid), columns, column_at](std::span<const double> nonlinear_parameters,
                                                           Eigen::Ref<Eigen::MatrixXd> design) {
    std::vector<double> points(grid->time_s.size());
    for (std::size_t column = 0; column < columns; ++column) {
      column_at(nonlinear_parameters, column, std::span<double>(points));
      design.col(static_cast<Eigen::Index>(column)) = grid->Project(points);
    }
  };
  return term;
}

/// A term of fixed columns at the rows.
SeparableTerm FixedTerm(Eigen::MatrixXd columns);

/// Whether each direction makes up 5 % of the motion at least.
bool MovesBothWays(const MotionGrid& grid);

/// Share of a column's variance that the nominal terms do not make up.
double ShareBesideNominal(const MotionGrid& grid, const Eigen::VectorXd& column);

/// Values from `low` to `high`, both included, at equal ratios.
std::vector<double> GeometricSteps(double low, double high, std::size_t count);

/// Rows added up over a time, each sum over the root of its count: white noise keeps its size, and of what is
/// shorter there is left what it comes to.
class RowSums {
 public:
  /// @param span_s  0: each row on its own. Sums do not reach over the gaps between rows.
  explicit RowSums(const MotionGrid& grid, double span_s = 0.0);

  Eigen::Index count() const { return nominal_basis_.rows(); }
  Eigen::MatrixXd Of(const Eigen::MatrixXd& rows) const;
  /// What least squares by the nominal terms' sums leaves of sums.
  Eigen::MatrixXd BesideNominal(const Eigen::MatrixXd& sums) const;
  /// The residual beside the nominal terms, and its weights; what is known badly of a single row is known of
  /// their sum.
  Eigen::VectorXd ResidualOf(const WeightedResidual& residual) const;
  Eigen::VectorXd WeightsOf(const WeightedResidual& residual) const;

 private:
  bool each_{};
  std::vector<std::pair<Eigen::Index, Eigen::Index>> spans_;  // first row, count
  Eigen::MatrixXd nominal_basis_;
};

/// Nonlinear parameters of a term of one column and no negative coefficient, and their columns beside the
/// nominal model.
class NonlinearParameterMap {
 public:
  /// Empty.
  NonlinearParameterMap(const MotionGrid& grid, std::vector<std::vector<double>> nonlinear_parameters,
                        double span_s = 0.0);

  /// Takes the column of a shape.
  void Take(Eigen::Index nonlinear_parameter, const Eigen::MatrixXd& rows);

  const std::vector<std::vector<double>>& nonlinear_parameters() const { return nonlinear_parameters_; }
  /// Roots of what each takes from the residual's weighted sum of squares; 0 for a negative coefficient.
  Eigen::VectorXf Roots(const WeightedResidual& residual) const;
  /// Of the residual as the map sees it, weighted.
  double MeanSquare(const WeightedResidual& residual) const;
  /// About the coefficient that goes with such a root.
  double Coefficient(Eigen::Index nonlinear_parameter, double root) const {
    return root / lengths_(nonlinear_parameter);
  }

 private:
  RowSums sums_;
  std::vector<std::vector<double>> nonlinear_parameters_;
  Eigen::MatrixXf columns_;  // sums × nonlinear parameters, each of length 1
  Eigen::VectorXd lengths_;  // that they had
};

/// Fills maps of the same nonlinear parameters.
void FillMaps(const SeparableTerm& term, std::size_t rows,
              std::initializer_list<NonlinearParameterMap*> maps);

/// Looks for nonlinear parameters of a term without fitting the rest again.
class StartSearch {
 public:
  /// Of the coefficient, where there is one column.
  enum class Sign { kEither, kPositive };

  /// All of them outlive the search.
  StartSearch(const MotionGrid& grid, const SeparableTerm& term, const WeightedResidual& residual,
              Sign sign = Sign::kEither, double span_s = 0.0);

  /// What the term's columns, beside the nominal ones, take from the residual's weighted sum of squares.
  double Drop(std::span<const double> nonlinear_parameters);
  /// Moves all nonlinear parameters together, from a simplex of these steps, while the drop grows (Nelder and
  /// Mead, Computer Journal 7 (1965) 308): for terms that depend on their nonlinear parameters too raggedly
  /// for slopes, and on each by the others.
  std::vector<double> Polish(const std::vector<double>& nonlinear_parameters,
                             const std::vector<double>& steps);

 private:
  RowSums sums_;
  const SeparableTerm& term_;
  Sign sign_;
  Eigen::MatrixXd rows_;
  Eigen::VectorXd weights_;
  Eigen::VectorXd weighted_;
};

/// The nonlinear parameters of `candidates` whose single column brings the largest drop, best first, at most
/// `count`.
std::vector<std::vector<double>> BestStarts(const MotionGrid& grid, const SeparableTerm& term,
                                            const std::vector<std::vector<double>>& candidates,
                                            const WeightedResidual& residual, std::size_t count);

}  // namespace strainwave::analysis::diagnosis
