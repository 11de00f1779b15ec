// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "analysis/diagnosis/hysteresis/gear.h"
#include "analysis/diagnosis/hysteresis/record.h"
#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// A number that a fit moves within [low, high].
struct FitNumber {
  double low{};
  double high{};
  double step{};            // for derivatives
  bool held{};              // chosen with the start and left there: which form of a cause, a time
  bool amount{};            // nothing is added where it is zero
  int state_of_record{-1};  // of a friction element at this record's first sample
};

/// What a search for starting numbers is given: a model without the effect, fitted.
struct LoopResidual {
  const LoopRecords& records;
  const LoopGrid& grid;                  // with the weights of the fit
  const GearLaw& law;                    // as fitted
  std::span<const double> residual_rad;  // of the grid's points
};

/// One cause, or nuisance term, of a hysteresis record: numbers that shape the gear or add to its twist.
class LoopEffect {
 public:
  virtual ~LoopEffect() = default;

  CauseRule rule;
  std::vector<FitNumber> numbers;
  bool shapes_gear{};        // ShapeGear does something; else Add does
  bool follows_gear{};       // what Add adds depends on the gear's twist
  bool needs_all_samples{};  // changes too fast for means of neighbours

  virtual void ShapeGear(std::span<const double> /*numbers*/, GearLaw& /*law*/) const {}
  /// Adds to the output angle, rad, at every point. `gear_rad` is the twist that the law gives.
  virtual void Add(std::span<const double> /*numbers*/, const LoopGrid& /*grid*/,
                   const Eigen::VectorXd& /*gear_rad*/, Eigen::VectorXd& /*total_rad*/) const {}
  /// True where a fit leaves a number alone in the form that these numbers have.
  virtual bool IsHeld(std::span<const double> /*numbers*/, std::size_t k) const { return numbers[k].held; }
  /// Index of a number on which the effect depends in a way of its own (a level, a time constant) and which a
  /// record may leave open over a wide range; −1 for none.
  virtual int NonlinearParameter() const { return -1; }
  /// As ModelFit::log_search_locations, of these numbers.
  virtual double LogSearchLocations(std::span<const double> /*numbers*/) const { return 0.0; }
  /// Numbers to start from, amounts zero: forms and nonlinear parameters that are worth trying.
  virtual std::vector<std::vector<double>> Starts(const LoopResidual& residual) const = 0;
  /// Richer forms of the effect as fitted, amounts zero that are new, or the same in another local minimum;
  /// each is kept only if it pays. Empty for most.
  virtual std::vector<std::vector<double>> RicherForms(std::span<const double> /*numbers*/,
                                                       const LoopResidual& /*residual*/) const {
    return {};
  }
  /// As people read it; `covariance` of the numbers, zero where errors were not asked for.
  virtual std::vector<ParameterValue> Describe(std::span<const double> numbers,
                                               const Eigen::MatrixXd& covariance) const = 0;
  /// The inverse.
  /// @throws std::invalid_argument naming a parameter that is missing or unknown.
  virtual std::vector<double> Restore(std::span<const ParameterValue> parameters) const = 0;
};

using LoopEffects = std::vector<std::unique_ptr<LoopEffect>>;

/// Appends the causes that change how the gear twists: backlash, asymmetric stiffness, cubic hardening,
/// torque zero offset, distributed friction, rate dependence.
void AppendGearEffects(const LoopRecords& records, LoopEffects& effects);
/// Appends one of these alone.
void AppendDistributedFriction(const LoopRecords& records, LoopEffects& effects);
void AppendRateDependence(const LoopRecords& records, LoopEffects& effects);
/// Appends the causes that add to the angle: creep, brake slip, thermal drift.
void AppendAddedEffects(const LoopRecords& records, LoopEffects& effects);
/// Appends the nuisance terms, which have no physical cause: other knees, smooth functions of the torque,
/// lines over output angle, time and torque, windows over torque and output angle, a jump and a window in
/// time.
void AppendNuisanceTerms(const LoopRecords& records, LoopEffects& effects);

/// Standard errors from a covariance.
std::vector<double> ErrorsOf(const Eigen::MatrixXd& covariance);

/// Value of a parameter by its name, if it is there.
const double* FindParameter(std::span<const ParameterValue> parameters, std::string_view name);
/// The same; throws std::invalid_argument naming cause and parameter where it is missing.
double RequireParameter(const CauseRule& rule, std::span<const ParameterValue> parameters,
                        std::string_view name);

}  // namespace strainwave::analysis::diagnosis
