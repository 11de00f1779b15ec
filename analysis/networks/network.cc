// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/network.h"

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

#include "analysis/networks/layers.h"

namespace strainwave::analysis::networks {
namespace {

using Eigen::Index;

struct Counts {
  Index weights{};
  Index biases{};
};

struct CountsOf {
  Shape input;

  Counts operator()(const Dense& layer) const { return {Index{layer.units} * input.size(), layer.units}; }
  Counts operator()(const Convolution& layer) const {
    return {Index{layer.filters} * input.channels * layer.kernel, layer.filters};
  }
  Counts operator()(const MaxPool&) const { return {}; }
  Counts operator()(const GlobalAveragePool&) const { return {}; }
};

// Whether it matters which index runs fastest.
bool IsSeries(const Shape& shape) { return shape.channels > 1 && shape.length > 1; }

struct ActivationOf {
  Activation operator()(const Dense& layer) const { return layer.activation; }
  Activation operator()(const Convolution& layer) const { return layer.activation; }
  Activation operator()(const MaxPool&) const { return Activation::kLinear; }
  Activation operator()(const GlobalAveragePool&) const { return Activation::kLinear; }
};

template <typename Scalar>
void RequireSizes(const Network& network, const Vector<Scalar>& parameters,
                  const Eigen::Ref<const Matrix<Scalar>>& inputs) {
  if (parameters.size() != network.parameter_count()) {
    throw std::invalid_argument(
        fmt::format("parameters has {} values (expected {})", parameters.size(), network.parameter_count()));
  }
  if (inputs.rows() != network.input_size()) {
    throw std::invalid_argument(
        fmt::format("inputs has {} rows (expected {})", inputs.rows(), network.input_size()));
  }
}

}  // namespace

Network::Network(Design design) : design_(std::move(design)) {
  if (design_.layers.empty()) throw std::invalid_argument("design has no layers (expected at least one)");
  Shape shape = design_.input;
  for (const Layer& layer : design_.layers) {
    const Shape after = OutputShape(layer, shape);
    const Counts counts = std::visit(CountsOf{shape}, layer);
    const bool dense = std::holds_alternative<Dense>(layer);
    const bool first = stages_.empty();
    const bool last = stages_.size() + 1 == design_.layers.size();
    stages_.push_back({layer, shape, after, parameter_count_, counts.weights, counts.biases,
                       IsSeries(shape) && dense != first, IsSeries(after) && !dense && last});
    parameter_count_ += counts.weights + counts.biases;
    shape = after;
  }
}

template <typename Scalar>
Vector<Scalar> InitialParameters(const Network& network, std::uint64_t seed) {
  // The engine's bits are fixed by the standard, those of its distributions are not.
  std::mt19937_64 random(seed);
  const auto even = [&random] { return static_cast<double>(random() >> 11U) * 0x1p-52 - 1.0; };
  Vector<Scalar> parameters = Vector<Scalar>::Zero(network.parameter_count());
  for (const Network::Stage& stage : network.stages()) {
    if (stage.weights == 0) continue;
    const auto inputs = static_cast<double>(stage.weights / stage.biases);
    const double outputs = static_cast<double>(stage.weights) / static_cast<double>(stage.input.channels) /
                           (std::holds_alternative<Dense>(stage.layer) ? stage.input.length : 1);
    const bool relu = std::visit(ActivationOf{}, stage.layer) == Activation::kRelu;
    const double bound = std::sqrt(6.0 / (relu ? inputs : inputs + outputs));
    for (Scalar& weight : parameters.segment(stage.weights_begin, stage.weights)) {
      weight = static_cast<Scalar>(bound * even());
    }
  }
  return parameters;
}

template <typename Scalar>
const Matrix<Scalar>& Forward(const Network& network, const Vector<Scalar>& parameters,
                              const Eigen::Ref<const Matrix<Scalar>>& inputs, Pass<Scalar>& pass) {
  RequireSizes(network, parameters, inputs);
  const std::size_t count = network.stages().size();
  pass.outputs.resize(count);
  pass.gradients.resize(count);
  ForwardStage<Scalar>(network.stages()[0], parameters, inputs, pass.outputs[0], pass);
  for (std::size_t i = 1; i < count; ++i) {
    ForwardStage<Scalar>(network.stages()[i], parameters, pass.outputs[i - 1], pass.outputs[i], pass);
  }
  return pass.outputs.back();
}

template <typename Scalar>
void Backward(const Network& network, const Vector<Scalar>& parameters,
              const Eigen::Ref<const Matrix<Scalar>>& inputs, Pass<Scalar>& pass, Vector<Scalar>& gradient) {
  gradient.resize(network.parameter_count());
  for (std::size_t i = network.stages().size(); i-- > 1;) {
    BackwardStage<Scalar>(network.stages()[i], parameters, pass.outputs[i - 1], pass.outputs[i],
                          pass.gradients[i], &pass.gradients[i - 1], gradient, pass);
  }
  BackwardStage<Scalar>(network.stages()[0], parameters, inputs, pass.outputs[0], pass.gradients[0], nullptr,
                        gradient, pass);
}

template Vector<float> InitialParameters(const Network&, std::uint64_t);
template Vector<double> InitialParameters(const Network&, std::uint64_t);
template const Matrix<float>& Forward(const Network&, const Vector<float>&,
                                      const Eigen::Ref<const Matrix<float>>&, Pass<float>&);
template const Matrix<double>& Forward(const Network&, const Vector<double>&,
                                       const Eigen::Ref<const Matrix<double>>&, Pass<double>&);
template void Backward(const Network&, const Vector<float>&, const Eigen::Ref<const Matrix<float>>&,
                       Pass<float>&, Vector<float>&);
template void Backward(const Network&, const Vector<double>&, const Eigen::Ref<const Matrix<double>>&,
                       Pass<double>&, Vector<double>&);

}  // namespace strainwave::analysis::networks
