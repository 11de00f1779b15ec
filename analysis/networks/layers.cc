// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/layers.h"

#include <algorithm>

#include "analysis/networks/products.h"

namespace strainwave::analysis::networks {
namespace {

using Eigen::Index;

template <typename Scalar>
using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
template <typename Scalar>
using ConstRows = Eigen::Map<const Rows<Scalar>>;

template <typename Parameters>
auto Biases(const Network::Stage& stage, Parameters& all) {
  return all.segment(stage.weights_begin + stage.weights, stage.biases);
}

// One sample as [channel][place].
template <typename Scalar>
ConstRows<Scalar> SampleOf(const Inputs<Scalar>& batch, Index sample, const Shape& shape) {
  return {batch.col(sample).data(), shape.channels, shape.length};
}
template <typename Scalar>
Eigen::Map<Rows<Scalar>> SampleOf(Matrix<Scalar>& batch, Index sample, const Shape& shape) {
  return {batch.col(sample).data(), shape.channels, shape.length};
}

// What the kernel sees: a column for each [channel · kernel], a row for each place of the output.
template <typename Scalar>
void GatherPatches(const Convolution& layer, const Network::Stage& stage, const Scalar* sample,
                   Matrix<Scalar>& patches) {
  const Index places = stage.output.length;
  patches.resize(places, Index{stage.input.channels} * layer.kernel);
  for (Index column = 0; column < patches.cols(); ++column) {
    const Scalar* from = sample + column / layer.kernel * stage.input.length + column % layer.kernel;
    Scalar* to = patches.col(column).data();
    if (layer.stride == 1) {
      std::copy_n(from, places, to);
    } else {
      for (Index place = 0; place < places; ++place) to[place] = from[place * layer.stride];
    }
  }
}

// The way back: what stands in the patches goes to the samples it was taken from.
template <typename Scalar>
void ScatterPatches(const Convolution& layer, const Network::Stage& stage, const Matrix<Scalar>& patches,
                    Scalar* sample) {
  for (Index column = 0; column < patches.cols(); ++column) {
    const Scalar* from = patches.col(column).data();
    Scalar* to = sample + column / layer.kernel * stage.input.length + column % layer.kernel;
    for (Index place = 0; place < patches.rows(); ++place) to[place * layer.stride] += from[place];
  }
}

template <typename Scalar>
Index PlaceOfGreatest(const ConstRows<Scalar>& sample, Index channel, Index begin, Index size) {
  Index greatest = begin;
  for (Index place = begin + 1; place < begin + size; ++place) {
    if (sample(channel, place) > sample(channel, greatest)) greatest = place;
  }
  return greatest;
}

template <typename Scalar>
struct ForwardLayer {
  const Network::Stage& stage;
  const Vector<Scalar>& parameters;
  const Inputs<Scalar>& input;
  Matrix<Scalar>& output;
  Pass<Scalar>& pass;

  void operator()(const Dense& layer) {
    const Index units = layer.units;
    MultiplyRows<Scalar>({parameters.data() + stage.weights_begin, input.rows()},
                         {input.data(), input.outerStride()}, {output.data(), 1, units}, units, input.cols(),
                         input.rows(), Sum::kOverwrite);
    output.colwise() += Biases(stage, parameters);
    Activate(layer.activation, output);
  }

  void operator()(const Convolution& layer) {
    const Scalar* weights = parameters.data() + stage.weights_begin;
    const Index terms = stage.weights / layer.filters;
    const Index places = stage.output.length;
    for (Index sample = 0; sample < input.cols(); ++sample) {
      GatherPatches(layer, stage, input.col(sample).data(), pass.patches);
      CombineRows<Scalar>({weights, terms, 1}, {pass.patches.data(), places},
                          {output.col(sample).data(), places}, layer.filters, terms, places, Sum::kOverwrite);
      SampleOf(output, sample, stage.output).colwise() += Biases(stage, parameters);
    }
    Activate(layer.activation, output);
  }

  void operator()(const MaxPool& layer) {
    for (Index sample = 0; sample < input.cols(); ++sample) {
      const auto in = SampleOf<Scalar>(input, sample, stage.input);
      auto out = SampleOf(output, sample, stage.output);
      for (Index channel = 0; channel < stage.output.channels; ++channel) {
        for (Index place = 0; place < stage.output.length; ++place) {
          out(channel, place) = in(channel, PlaceOfGreatest(in, channel, place * layer.stride, layer.size));
        }
      }
    }
  }

  void operator()(const GlobalAveragePool&) {
    for (Index sample = 0; sample < input.cols(); ++sample) {
      output.col(sample) = SampleOf<Scalar>(input, sample, stage.input).rowwise().mean();
    }
  }
};

template <typename Scalar>
struct BackwardLayer {
  const Network::Stage& stage;
  const Vector<Scalar>& parameters;
  const Inputs<Scalar>& input;
  const Matrix<Scalar>& output;
  Matrix<Scalar>& output_gradient;
  Matrix<Scalar>* input_gradient;
  Vector<Scalar>& parameter_gradient;
  Pass<Scalar>& pass;

  void operator()(const Dense& layer) {
    MultiplyBySlope(layer.activation, output, output_gradient);
    const Index units = layer.units;
    const Index inputs = input.rows();
    const Scalar* gradient = output_gradient.data();
    CombineRows<Scalar>({gradient, 1, units}, {input.data(), input.outerStride()},
                        {parameter_gradient.data() + stage.weights_begin, inputs}, units, input.cols(),
                        inputs, Sum::kOverwrite);
    Biases(stage, parameter_gradient) = output_gradient.rowwise().sum();
    if (input_gradient == nullptr) return;
    CombineRows<Scalar>({gradient, units, 1}, {parameters.data() + stage.weights_begin, inputs},
                        {input_gradient->data(), inputs}, input.cols(), units, inputs, Sum::kOverwrite);
  }

  void operator()(const Convolution& layer) {
    MultiplyBySlope(layer.activation, output, output_gradient);
    const Scalar* weights = parameters.data() + stage.weights_begin;
    const Index terms = stage.weights / layer.filters;
    const Index places = stage.output.length;
    Biases(stage, parameter_gradient).setZero();
    if (input_gradient != nullptr) input_gradient->setZero();
    pass.patch_gradients.resize(places, terms);
    for (Index sample = 0; sample < input.cols(); ++sample) {
      const Scalar* gradient = output_gradient.col(sample).data();
      GatherPatches(layer, stage, input.col(sample).data(), pass.patches);
      MultiplyRows<Scalar>({gradient, places}, {pass.patches.data(), places},
                           {parameter_gradient.data() + stage.weights_begin, terms, 1}, layer.filters, terms,
                           places, sample == 0 ? Sum::kOverwrite : Sum::kAdd);
      Biases(stage, parameter_gradient) += SampleOf(output_gradient, sample, stage.output).rowwise().sum();
      if (input_gradient == nullptr) continue;
      CombineRows<Scalar>({weights, 1, terms}, {gradient, places}, {pass.patch_gradients.data(), places},
                          terms, layer.filters, places, Sum::kOverwrite);
      ScatterPatches(layer, stage, pass.patch_gradients, input_gradient->col(sample).data());
    }
  }

  void operator()(const MaxPool& layer) {
    if (input_gradient == nullptr) return;
    input_gradient->setZero();
    for (Index sample = 0; sample < input.cols(); ++sample) {
      const auto in = SampleOf<Scalar>(input, sample, stage.input);
      const auto gradient = SampleOf(output_gradient, sample, stage.output);
      auto out = SampleOf(*input_gradient, sample, stage.input);
      for (Index channel = 0; channel < stage.output.channels; ++channel) {
        for (Index place = 0; place < stage.output.length; ++place) {
          out(channel, PlaceOfGreatest(in, channel, place * layer.stride, layer.size)) +=
              gradient(channel, place);
        }
      }
    }
  }

  void operator()(const GlobalAveragePool&) {
    if (input_gradient == nullptr) return;
    const auto share = Scalar(1) / static_cast<Scalar>(stage.input.length);
    for (Index sample = 0; sample < input.cols(); ++sample) {
      SampleOf(*input_gradient, sample, stage.input).colwise() = (share * output_gradient.col(sample)).eval();
    }
  }
};

}  // namespace

template <typename Scalar>
void ForwardStage(const Network::Stage& stage, const Vector<Scalar>& parameters, const Inputs<Scalar>& input,
                  Matrix<Scalar>& output, Pass<Scalar>& pass) {
  output.resize(stage.output.size(), input.cols());
  std::visit(ForwardLayer<Scalar>{stage, parameters, input, output, pass}, stage.layer);
}

template <typename Scalar>
void BackwardStage(const Network::Stage& stage, const Vector<Scalar>& parameters, const Inputs<Scalar>& input,
                   const Matrix<Scalar>& output, Matrix<Scalar>& output_gradient,
                   Matrix<Scalar>* input_gradient, Vector<Scalar>& parameter_gradient, Pass<Scalar>& pass) {
  if (input_gradient != nullptr) input_gradient->resize(stage.input.size(), input.cols());
  std::visit(BackwardLayer<Scalar>{stage, parameters, input, output, output_gradient, input_gradient,
                                   parameter_gradient, pass},
             stage.layer);
}

template void ForwardStage(const Network::Stage&, const Vector<float>&, const Inputs<float>&, Matrix<float>&,
                           Pass<float>&);
template void ForwardStage(const Network::Stage&, const Vector<double>&, const Inputs<double>&,
                           Matrix<double>&, Pass<double>&);
template void BackwardStage(const Network::Stage&, const Vector<float>&, const Inputs<float>&,
                            const Matrix<float>&, Matrix<float>&, Matrix<float>*, Vector<float>&,
                            Pass<float>&);
template void BackwardStage(const Network::Stage&, const Vector<double>&, const Inputs<double>&,
                            const Matrix<double>&, Matrix<double>&, Matrix<double>*, Vector<double>&,
                            Pass<double>&);

}  // namespace strainwave::analysis::networks
