// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/study.h"
#include "analysis/diagnosis/vibration/solver.h"
#include "analysis/diagnosis/vibration/starts.h"

/// Names and numbers of vibration models as people and files read them. First what a reader looks for (order,
/// frequency, amplitude in the strongest channel), then all that is needed to run the model again:
/// `cosine_1_accel_x` and `sine_1_accel_x` of every pair of columns in every channel. Amplitudes are those of
/// the channel itself.
namespace strainwave::analysis::diagnosis {

/// "m/s^2" for "accel_x_m_per_s2"; empty for a name without a unit.
std::string CoefficientName(const VibrationTerm& term, Eigen::Index column, const std::string& channel);

std::string UnitOfChannel(const std::string& channel);
/// "amplitude_m_per_s2" for channels in m/s², else "amplitude".
std::string AmplitudeName(const VibrationSamples& samples);

std::vector<ParameterValue> DescribeNominal(const VibrationSamples& samples,
                                            const VibrationSolution& solution);

/// @param nonlinear_parameters  covariance of all nonlinear parameters of the solution; empty where no errors
///   are wanted.
std::vector<ParameterValue> DescribeTerm(const VibrationSamples& samples, const VibrationSolution& solution,
                                         std::size_t term, VibrationCause cause,
                                         const Eigen::MatrixXd& nonlinear_parameters);

/// Response of the nominal model, each channel in its own unit.
/// @throws std::invalid_argument naming a parameter that is unknown or missing.
Eigen::VectorXd PredictNominal(const VibrationSamples& samples, std::span<const ParameterValue> nominal);

/// What a cause adds. A resonance that noise drives gives one draw of it, always the same.
/// @throws std::invalid_argument naming a parameter that is missing.
Eigen::VectorXd PredictTerm(const VibrationSamples& samples, VibrationCause cause, const std::string& name,
                            std::span<const ParameterValue> parameters);

}  // namespace strainwave::analysis::diagnosis
