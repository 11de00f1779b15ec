// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// A lightly damped oscillator that noise drives, in white noise: y = u + v. From one sample to the next its
/// own past predicts part of it; what is left are the innovations, which are white, so that sums of their
/// squares compare models as they do for any other term.
struct Narrowband {
  double frequency_Hz{};
  double damping_ratio{};
  double log_ratio{};  // ln(variance of u / variance of v)
};

/// e[k] = y[k] + a₁ y[k−1] + a₂ y[k−2] − c₁ e[k−1] − c₂ e[k−2]: the poles of the oscillator over those of the
/// best predictor (spectral factor of both noises together).
struct InnovationFilter {
  double a1{}, a2{}, c1{}, c2{};
  double variance{1.0};  // of the innovations, with v's as one
};
InnovationFilter FilterOf(const Narrowband& narrowband, double period_s);

/// Replaces each sample of each column by what the samples before it predict. Begins anew where `breaks`
/// says so; for a sample that is missing what was predicted stands in.
/// @param filters  one a column, or one for all
/// @param missing  empty: none is
void Predict(std::span<const InnovationFilter> filters, std::span<const char> breaks,
             std::span<const char> missing, Eigen::Ref<Eigen::MatrixXd> columns);

/// Of each column the last two samples and the last two innovations, the newest first; zero before the first.
using PredictionState = Eigen::Matrix4Xd;

/// The same of rows that follow on those whose state is given, which becomes that of the last row here.
void Predict(std::span<const InnovationFilter> filters, std::span<const char> breaks,
             std::span<const char> missing, Eigen::Ref<Eigen::MatrixXd> columns,
             Eigen::Ref<PredictionState> state);

}  // namespace strainwave::analysis::diagnosis
