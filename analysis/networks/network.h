// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "analysis/networks/design.h"

/// A network's numbers, forwards and backwards. All parameters stand in one vector, so that whoever trains,
/// stores, averages or exports them needs to know no layer. `Scalar` is float or double.
namespace strainwave::analysis::networks {

/// One sample a column.
template <typename Scalar>
using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
template <typename Scalar>
using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

/// A design with its shapes, and where each layer's parameters stand: first the weights as
/// [output][input][kernel], the last index running fastest, then one bias an output.
class Network {
 public:
  struct Stage {
    Layer layer;
    Shape input;
    Shape output;
    Eigen::Index weights_begin{};
    Eigen::Index weights{};  // 0 for layers without parameters
    Eigen::Index biases{};   // behind the weights
    // Between stages series stand with the channels of each position side by side, where the networks' own
    // input, output and dense layers have [channel][position]: whether this stage turns what it takes, or
    // gives.
    bool turns_input{};
    bool turns_output{};
  };

  /// @throws std::invalid_argument if the design has no layer or a layer does not fit.
  explicit Network(Design design);

  const Design& design() const { return design_; }
  const std::vector<Stage>& stages() const { return stages_; }
  Eigen::Index parameter_count() const { return parameter_count_; }
  Eigen::Index input_size() const { return design_.input.size(); }
  Eigen::Index output_size() const { return stages_.back().output.size(); }

 private:
  Design design_;
  std::vector<Stage> stages_;
  Eigen::Index parameter_count_{};
};

/// Memory of one pass; belongs to one thread at a time, and is used again.
template <typename Scalar>
struct Pass {
  std::vector<Matrix<Scalar>> outputs;    // of each stage; of series, but for the last, [position][channel]
  std::vector<Matrix<Scalar>> gradients;  // of the loss, by the output of each stage
  Vector<Scalar> weights;                 // of a convolution, in the order of its sums
  Vector<Scalar> weight_gradient;
  Vector<Scalar> input_positions;  // one sample, turned
  Vector<Scalar> output_positions;
  Matrix<Scalar> turned;  // all samples
};

/// Weights drawn evenly from ±√(6 / (inputs + outputs)) (Glorot & Bengio 2010), before ReLU from ±√(6 /
/// inputs) (He et al. 2015); biases 0. The same seed gives the same bits on every machine.
template <typename Scalar>
Vector<Scalar> InitialParameters(const Network& network, std::uint64_t seed);

/// @param inputs  input_size × N.
/// @return output_size × N, a matrix that stands in `pass`.
/// @throws std::invalid_argument if a size does not fit.
template <typename Scalar>
const Matrix<Scalar>& Forward(const Network& network, const Vector<Scalar>& parameters,
                              const Eigen::Ref<const Matrix<Scalar>>& inputs, Pass<Scalar>& pass);

/// The gradient by all parameters, after `Forward` with the same arguments.
/// @param pass  its last gradient holds that of the loss by the outputs.
/// @param gradient  overwritten.
template <typename Scalar>
void Backward(const Network& network, const Vector<Scalar>& parameters,
              const Eigen::Ref<const Matrix<Scalar>>& inputs, Pass<Scalar>& pass, Vector<Scalar>& gradient);

}  // namespace strainwave::analysis::networks
