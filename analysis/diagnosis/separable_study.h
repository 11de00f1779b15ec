// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// When a fit moves a shape away from where its start put it: always, not while candidates are compared (a
/// detail that few records know, and that would cost each of them its power), before what was found is
/// reported only where the likelihood pays for it (zero where it does not), or never (one of a list).
enum class Moved { kAlways, kForErrors, kWhereItPays, kNever };

/// A number on which a term depends in a curved way: an order, a centre, a time constant. Fits keep it in
/// [low, high].
struct NonlinearParameterRange {
  double low{};
  double high{};
  double step{};  // about what a change has to be to matter: for derivatives, and the first trust region
  /// True where [low, high] is what is known before: the number is charged for by how much of that the record
  /// excludes, not as if each sample told of it (the evidence of Laplace; Kass & Raftery, JASA 90 (1995)
  /// 773).
  bool known{};
  Moved moved{Moved::kAlways};
};

/// Residual of the rest of the model, in which a search looks for nonlinear parameters.
struct WeightedResidual {
  std::span<const double> values;
  std::span<const double> weights;

  /// Weighted.
  double MeanSquare() const;
};

/// A term that is linear in its coefficients once its nonlinear parameters are fixed.
struct SeparableTerm {
  std::size_t columns{1};
  std::vector<NonlinearParameterRange> nonlinear_parameters;
  /// What each squared coefficient adds to the sum of squares; terms without nonlinear parameters only.
  double ridge{};
  /// Fills n × columns at these nonlinear parameters.
  std::function<void(std::span<const double> nonlinear_parameters, Eigen::Ref<Eigen::MatrixXd> design)> fill;
  /// Nonlinear parameters to start from, best first, a few; unused without nonlinear parameters. A search
  /// takes the first `most_starts`; errors are those over all that the record does not exclude.
  std::function<std::vector<std::vector<double>>(const WeightedResidual& residual)> starts;
  std::size_t most_starts{static_cast<std::size_t>(-1)};
  /// As Study::ModelUncertainty, of these coefficients and nonlinear parameters; empty for none.
  std::function<Eigen::VectorXd(std::span<const double> numbers)> model_uncertainty;
  /// As ModelFit::log_search_locations, of these nonlinear parameters; empty for 0.
  std::function<double(std::span<const double> nonlinear_parameters)> log_search_locations;
  /// Coefficients (then nonlinear parameters) as people read them; `covariance` is of both together.
  std::function<std::vector<ParameterValue>(std::span<const double> numbers,
                                            const Eigen::MatrixXd& covariance)>
      describe;
  /// The inverse: coefficients, then nonlinear parameters, from the parameters that `describe` makes (in its
  /// order).
  std::function<std::vector<double>(std::span<const double> values)> restore;
};

/// What a study of separable terms consists of. The first `nominal_terms` have no nonlinear parameters.
struct SeparableModel {
  std::vector<double> measured;
  std::vector<std::size_t> segments{0};
  std::vector<double> weights;  // as Study::Weights
  std::vector<SeparableTerm> nominal;
  std::vector<SeparableTerm> causes;  // in the order of `rules`
  std::vector<CauseRule> rules;
  std::vector<Regressor> regressors;
  std::string unit;
  double unit_per_si{1.0};
  double noise_floor{};
  double rounding{};  // as Study::Rounding
  double filtered_out_variance{};
  std::size_t block_length{1};
  int largest_noise_order{4};
  bool spikes_are_outliers{true};
  std::vector<double> turn_angles_rad;  // as Study::AnglesOnTurn
  std::vector<std::string> warnings;
  std::function<std::vector<UserQuantity>(const Eigen::VectorXd& predicted)> quantities;
};

/// A study whose terms are separable: linear coefficients by projection, nonlinear parameters by Gauss–Newton
/// on what the projection leaves (variable projection; Golub & Pereyra, SIAM J. Numer. Anal. 10 (1973) 413),
/// from several starts for a cause that the starting fit does not have yet.
class SeparableStudy final : public Study {
 public:
  /// @throws std::invalid_argument if sizes do not agree.
  explicit SeparableStudy(SeparableModel model);

  std::span<const double> measured() const override { return model_.measured; }
  std::span<const std::size_t> segments() const override { return model_.segments; }
  const std::vector<CauseRule>& causes() const override { return model_.rules; }
  const std::vector<Regressor>& regressors() const override { return model_.regressors; }
  std::string unit() const override { return model_.unit; }
  double unit_per_si() const override { return model_.unit_per_si; }
  double NoiseFloor() const override { return model_.noise_floor; }
  double Rounding() const override { return model_.rounding; }
  std::span<const double> Weights() const override { return model_.weights; }
  double FilteredOutVariance() const override { return model_.filtered_out_variance; }
  std::size_t BlockLength() const override { return model_.block_length; }
  int LargestNoiseOrder() const override { return model_.largest_noise_order; }
  bool SpikesAreOutliers() const override { return model_.spikes_are_outliers; }
  std::span<const double> AnglesOnTurn() const override { return model_.turn_angles_rad; }
  const std::vector<std::string>& warnings() const override { return model_.warnings; }
  std::vector<UserQuantity> Quantities(const Eigen::VectorXd& predicted) const override;
  ModelFit Fit(std::span<const std::size_t> cause_indices, std::span<const double> weights,
               const ModelFit* start, FitPurpose purpose) const override;
  std::vector<double> ModelUncertainty(const ModelFit& fit) const override;
  Eigen::VectorXd Predict(std::span<const ParameterValue> nominal,
                          std::span<const NamedCause> causes) const override;
  std::unique_ptr<Study> WithResponse(std::span<const double> measured) const override;
  std::optional<DrawnEffect> DrawEffect(std::size_t cause, const ModelFit& beside,
                                        std::uint64_t draw) const override;

 private:
  SeparableModel model_;
  Eigen::MatrixXd nominal_design_;
};

/// The describe/restore pair of A cos θ + B sin θ = amplitude · cos(θ − phase): amplitude in a unit
/// (`amplitude_name`, times `unit_per_si`), phase in degrees. For terms of exactly two columns (cosine, sine)
/// and no nonlinear parameters, or with nonlinear parameters described by `NonlinearParameterDescription`
/// behind them.
struct NonlinearParameterDescription {
  std::string name;
  std::string unit;
  double unit_per_si{1.0};
};
void DescribeAsHarmonic(SeparableTerm& term, std::string amplitude_name, std::string unit, double unit_per_si,
                        std::vector<NonlinearParameterDescription> nonlinear_parameters = {});

/// The pair of coefficients, then nonlinear parameters, each a number of its own.
void DescribeEach(SeparableTerm& term, std::vector<NonlinearParameterDescription> numbers);

}  // namespace strainwave::analysis::diagnosis
