// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>
#include <utility>
#include <vector>

#include "analysis/diagnosis/hysteresis/effects.h"

namespace strainwave::analysis::diagnosis {

/// Indices of the nominal model's numbers; behind them the numbers of the effects, one after the other.
enum LoopNumber : int { kLnK1, kLnK2, kLnK3, kLnFriction, kLnYield, kFirstOfRecord };
/// Of each record: its offset in arcmin about the record's centre, the element's state at its start.
inline constexpr int kNumbersOfRecord = 2;

/// Share of T2 that the torque has to reach for K3 to be fitted.
inline constexpr double kReachesThird = 1.02;

/// The nominal model of a set of records with some effects: one vector of numbers in, output angles out.
class LoopModel {
 public:
  LoopModel(const LoopRecords& records, std::vector<const LoopEffect*> effects);

  int size() const { return static_cast<int>(numbers_.size()); }
  int nominal_size() const { return nominal_size_; }
  const std::vector<FitNumber>& numbers() const { return numbers_; }
  const std::vector<const LoopEffect*>& effects() const { return effects_; }
  bool NeedsAllSamples() const;

  /// Leaves the friction's state at the start of these records alone (one flag a record): a fit to samples
  /// that come later cannot know it.
  void KeepStarts(std::vector<bool> of_record) { kept_starts_ = std::move(of_record); }

  /// Leaves one number alone, whatever the fit.
  void Hold(int number) { held_.push_back(number); }

  /// Numbers of one effect.
  std::span<const double> Of(std::size_t effect, const Eigen::VectorXd& x) const;
  std::span<double> Of(std::size_t effect, Eigen::VectorXd& x) const;
  /// True where a fit leaves this number alone at these numbers.
  std::vector<bool> Held(const Eigen::VectorXd& x) const;
  int FreeParameters(const Eigen::VectorXd& x) const;
  /// As ModelFit::log_search_locations.
  double LogSearchLocations(const Eigen::VectorXd& x) const;

  GearLaw LawOf(const Eigen::VectorXd& x) const;
  /// Output angle about each record's centre, rad.
  Eigen::VectorXd Predict(const Eigen::VectorXd& x, const LoopGrid& grid) const;
  /// The same with its derivatives by the numbers that are free (the other columns are zero).
  Eigen::VectorXd Predict(const Eigen::VectorXd& x, const LoopGrid& grid, Eigen::MatrixXd& derivatives) const;
  /// What the amounts of one effect add per unit, one column each, forwards from where they are. `gear_rad`
  /// is the gear's twist at these numbers, of which causes that only add to it make use.
  Eigen::MatrixXd AmountColumns(const Eigen::VectorXd& x, const LoopGrid& grid, std::size_t effect,
                                const Eigen::VectorXd& gear_rad) const;
  /// Indices of these amounts.
  std::vector<int> Amounts(const Eigen::VectorXd& x, std::size_t effect) const;

 private:
  void AddOffsets(const Eigen::VectorXd& x, const LoopGrid& grid, Eigen::VectorXd& total) const;
  void AddEffects(const Eigen::VectorXd& x, const LoopGrid& grid, const Eigen::VectorXd& gear, bool followers,
                  Eigen::VectorXd& total) const;

  const LoopRecords& records_;
  std::vector<const LoopEffect*> effects_;
  std::vector<FitNumber> numbers_;
  std::vector<int> first_of_effect_;
  int nominal_size_{};
  std::vector<bool> kept_starts_;
  std::vector<int> held_;
};

/// One effect of a model as people read it.
std::vector<ParameterValue> DescribeEffect(const LoopModel& model, std::size_t effect,
                                           const Eigen::VectorXd& numbers, const Eigen::MatrixXd& covariance);

/// Numbers that fit best, found from `start`, within their bounds.
struct LoopSolution {
  Eigen::VectorXd numbers;
  double cost{};  // weighted sum of squares, rad²
};
/// Of a search that goes to its end.
inline constexpr int kMostIterations = 25;
/// Levenberg-Marquardt with bounds: a number at its bound that would leave it stays there for the step.
LoopSolution SolveLoop(const LoopModel& model, const LoopGrid& grid, const Eigen::VectorXd& start,
                       int most_iterations);

}  // namespace strainwave::analysis::diagnosis
