// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/layers.h"

#include <algorithm>

#include "analysis/networks/products.h"
#include "analysis/networks/transpose.h"

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

// Convolutions are computed with the channels of a place side by side: what a kernel sees is then one stretch
// of memory, and every sum a combination of rows. [channel][place] becomes [place][channel], and back.
template <typename Scalar>
void TurnToPlaces(const Scalar* sample, const Shape& shape, Scalar* turned) {
  Transpose(sample, shape.channels, shape.length, turned);
}
template <typename Scalar>
void TurnToChannels(const Scalar* turned, const Shape& shape, Scalar* sample) {
  Transpose(turned, shape.length, shape.channels, sample);
}

// Weights [filter][channel][kernel] as [kernel][channel][filter].
template <typename Scalar>
void TurnWeights(const Convolution& layer, int channels, const Scalar* weights, Scalar* turned) {
  for (Index kernel = 0; kernel < layer.kernel; ++kernel) {
    for (Index channel = 0; channel < channels; ++channel) {
      for (Index filter = 0; filter < layer.filters; ++filter) {
        *turned++ = weights[(filter * channels + channel) * layer.kernel + kernel];
      }
    }
  }
}
template <typename Scalar>
void TurnWeightsBack(const Convolution& layer, int channels, const Scalar* turned, Scalar* weights) {
  for (Index kernel = 0; kernel < layer.kernel; ++kernel) {
    for (Index channel = 0; channel < channels; ++channel) {
      for (Index filter = 0; filter < layer.filters; ++filter) {
        weights[(filter * channels + channel) * layer.kernel + kernel] = *turned++;
      }
    }
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
    const Index filters = layer.filters;
    const Index channels = stage.input.channels;
    const Index terms = channels * layer.kernel;
    const Index places = stage.output.length;
    pass.weights.resize(stage.weights);
    TurnWeights(layer, stage.input.channels, parameters.data() + stage.weights_begin, pass.weights.data());
    pass.input_places.resize(stage.input.size());
    pass.output_places.resize(stage.output.size());
    for (Index sample = 0; sample < input.cols(); ++sample) {
      TurnToPlaces(input.col(sample).data(), stage.input, pass.input_places.data());
      CombineRows<Scalar>({pass.input_places.data(), channels * layer.stride, 1},
                          {pass.weights.data(), filters}, {pass.output_places.data(), filters}, places, terms,
                          filters, Sum::kOverwrite);
      Eigen::Map<Matrix<Scalar>>(pass.output_places.data(), filters, places).colwise() +=
          Biases(stage, parameters);
      TurnToChannels(pass.output_places.data(), stage.output, output.col(sample).data());
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
    const Index filters = layer.filters;
    const Index channels = stage.input.channels;
    const Index terms = channels * layer.kernel;
    const Index places = stage.output.length;
    Biases(stage, parameter_gradient).setZero();
    pass.input_places.resize(stage.input.size());
    pass.output_places.resize(stage.output.size());
    pass.weight_gradient.resize(stage.weights);
    if (input_gradient != nullptr) TurnInputWeights(layer);
    for (Index sample = 0; sample < input.cols(); ++sample) {
      TurnToPlaces(input.col(sample).data(), stage.input, pass.input_places.data());
      TurnToPlaces(output_gradient.col(sample).data(), stage.output, pass.output_places.data());
      CombineRows<Scalar>({pass.input_places.data(), 1, channels * layer.stride},
                          {pass.output_places.data(), filters}, {pass.weight_gradient.data(), filters}, terms,
                          places, filters, sample == 0 ? Sum::kOverwrite : Sum::kAdd);
      Biases(stage, parameter_gradient) +=
          Eigen::Map<const Matrix<Scalar>>(pass.output_places.data(), filters, places).rowwise().sum();
      if (input_gradient != nullptr) BackToInput(layer, input_gradient->col(sample).data());
    }
    TurnWeightsBack(layer, stage.input.channels, pass.weight_gradient.data(),
                    parameter_gradient.data() + stage.weights_begin);
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

 private:
  // [filter][channel][kernel] as [kernel][filter][channel]: what each filter hands back to the channels.
  void TurnInputWeights(const Convolution& layer) {
    const Index channels = stage.input.channels;
    const Scalar* weights = parameters.data() + stage.weights_begin;
    pass.weights.resize(stage.weights);
    Scalar* to = pass.weights.data();
    for (Index kernel = 0; kernel < layer.kernel; ++kernel) {
      for (Index filter = 0; filter < layer.filters; ++filter) {
        for (Index channel = 0; channel < channels; ++channel) {
          *to++ = weights[(filter * channels + channel) * layer.kernel + kernel];
        }
      }
    }
  }

  // From the gradient in `output_places` to that of one sample of the input.
  void BackToInput(const Convolution& layer, Scalar* sample) {
    const Index channels = stage.input.channels;
    const Index filters = layer.filters;
    pass.input_places.setZero();
    for (Index kernel = 0; kernel < layer.kernel; ++kernel) {
      CombineRows<Scalar>({pass.output_places.data(), filters, 1},
                          {pass.weights.data() + kernel * filters * channels, channels},
                          {pass.input_places.data() + kernel * channels, channels * layer.stride},
                          stage.output.length, filters, channels, Sum::kAdd);
    }
    TurnToChannels(pass.input_places.data(), stage.input, sample);
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
