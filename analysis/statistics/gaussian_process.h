// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

/// A surface through scattered measurements, with its uncertainty:
///
///   y(x) = m + f(x) + e,  cov f(x), f(x') = σf² exp(−½ Σ_k (x_k − x'_k)² / h_k²),  var e = σn²
///
/// Source: docs/sources.md#rasmussen-2006, chapters 2 and 5; eq. 2.28 and 2.41 for an estimated mean.
namespace strainwave::analysis::statistics {

struct GaussianProcessParameters {
  double signal_variance{1.0};  // σf², in the square of the unit of the values
  Eigen::VectorXd length;       // h, one a coordinate, in its unit
  double noise_variance{0.1};   // σn², of one measurement, in the square of the unit of the values
};

/// What of the surface is not told by the parameters.
enum class MeanOf {
  kZero,      // m = 0
  kConstant,  // m is estimated, by generalised least squares
};

/// Measurements, those at one point together: their likelihood depends on their means, their number and the
/// sum of squares about the means alone.
struct ReplicatedData {
  Eigen::MatrixXd points;  // groups × coordinates
  Eigen::VectorXd means;   // of the measurements at each
  Eigen::VectorXd counts;
  double within{};  // sum of squares about the means

  double size() const { return counts.sum(); }
};
/// @param points  n × coordinates.
/// @throws std::invalid_argument if sizes differ, there is no measurement, or a number is not finite.
ReplicatedData Replicated(const Eigen::MatrixXd& points, const Eigen::VectorXd& values);

/// ln p(y), and its gradient by ln σf², ln h_1 … ln h_d (or one ln h, where `one_length`), ln σn².
struct LogLikelihood {
  double value{};
  Eigen::VectorXd gradient;
};
/// @throws std::invalid_argument for a parameter that is not positive or another number of lengths;
///   std::domain_error where the covariance is singular.
LogLikelihood LogMarginalLikelihood(const ReplicatedData& data, const GaussianProcessParameters& parameters,
                                    MeanOf mean, bool one_length = false);

/// What is known of the surface at some points.
struct Posterior {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;  // of the surface; a new measurement has σn² more of variance
};

/// A surface with its parameters.
class GaussianProcess {
 public:
  /// @throws as LogMarginalLikelihood.
  GaussianProcess(ReplicatedData data, GaussianProcessParameters parameters, MeanOf mean);

  const ReplicatedData& data() const { return data_; }
  const GaussianProcessParameters& parameters() const { return parameters_; }
  MeanOf mean_of() const { return mean_of_; }
  double mean() const { return mean_; }  // m
  double log_likelihood() const { return log_likelihood_; }

  /// @param points  p × coordinates.
  Posterior At(const Eigen::MatrixXd& points) const;

 private:
  ReplicatedData data_;
  GaussianProcessParameters parameters_;
  MeanOf mean_of_;
  double mean_{};
  double log_likelihood_{};
  Eigen::MatrixXd inverse_;  // of the covariance of the means
  Eigen::VectorXd weights_;  // inverse · (means − m)
};

struct GaussianProcessFitSettings {
  MeanOf mean{MeanOf::kConstant};
  bool one_length{};  // for all coordinates
  int restarts{10};   // beside the first start
  std::uint64_t seed{1};
};

/// The parameters of greatest likelihood, by quasi-Newton steps from several starts. σf² and m follow from
/// the others in closed form (profile likelihood).
/// @throws as LogMarginalLikelihood; std::invalid_argument for fewer than 3 measurements, or values that are
///   all the same.
GaussianProcess FitGaussianProcess(const ReplicatedData& data, const GaussianProcessFitSettings& settings);

/// The profile likelihood that the fit climbs, for `gaussian_process_fit.cc`: of ln h and ln (σn² / σf²).
/// Keeps its memory; one object a thread.
class ProfileLikelihood {
 public:
  ProfileLikelihood(const ReplicatedData& data, MeanOf mean, bool one_length);

  Eigen::Index parameter_count() const { return lengths_ + 1; }
  /// −∞ and no gradient where the covariance is singular.
  double Compute(const Eigen::VectorXd& log_parameters, Eigen::VectorXd& gradient);
  /// σf² of the last call.
  double signal_variance() const { return signal_variance_; }

 private:
  const ReplicatedData& data_;
  MeanOf mean_;
  Eigen::Index lengths_;
  Eigen::Index groups_;
  Eigen::MatrixXd squares_;  // pairs × lengths: of the distances of groups j < i, row by row
  std::vector<double> kernel_;
  std::vector<double> factor_;   // upper, row by row
  std::vector<double> lower_;    // inverse of its transpose
  std::vector<double> inverse_;  // lower half
  std::vector<double> weights_;
  double log_counts_{};
  double signal_variance_{};
};

}  // namespace strainwave::analysis::statistics
