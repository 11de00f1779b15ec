// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/networks/network.h"

/// One stage forwards and backwards; `network.h` puts them in a row. Every function takes the stage's weights
/// and biases from the vector of all parameters.
namespace strainwave::analysis::networks {

template <typename Scalar>
using Inputs = Eigen::Ref<const Matrix<Scalar>>;

/// output: sized and filled.
template <typename Scalar>
void ForwardStage(const Network::Stage& stage, const Vector<Scalar>& parameters, const Inputs<Scalar>& input,
                  Matrix<Scalar>& output, Pass<Scalar>& pass);

/// @param output_gradient  by the stage's output; comes back changed.
/// @param input_gradient  sized and filled; nullptr where nobody asks for it.
template <typename Scalar>
void BackwardStage(const Network::Stage& stage, const Vector<Scalar>& parameters, const Inputs<Scalar>& input,
                   const Matrix<Scalar>& output, Matrix<Scalar>& output_gradient,
                   Matrix<Scalar>* input_gradient, Vector<Scalar>& parameter_gradient, Pass<Scalar>& pass);

}  // namespace strainwave::analysis::networks
