// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/layers.h"

#include <algorithm>

#include "analysis/networks/transpose.h"
#include "analysis/products.h"

namespace strainwave::analysis::networks {
namespace {

using Eigen::Index;

// From so many on it pays to turn the weights of a dense layer about, as sums of rows need less of the cache
// than products of rows: an epoch of 2500 samples of `ann` at once (predictor_benchmark).
constexpr Index kManySamples = 128;

template <typename Parameters>
auto Biases(const Network::Stage& stage, Parameters& all) {
  return all.segment(stage.weights_begin + stage.weights, stage.biases);
}

// [channel][position] becomes [position][channel], and back.
template <typename Scalar>
void TurnToPositions(const Scalar* sample, const Shape& shape, Scalar* turned) {
  Transpose(sample, shape.channels, shape.length, turned);
}
template <typename Scalar>
void TurnToChannels(const Scalar* turned, const Shape& shape, Scalar* sample) {
  Transpose(turned, shape.length, shape.channels, sample);
}

// Samples of a stage with the channels of a position side by side, whichever way they stand: what a kernel
// sees is then one segment of memory, and every sum a combination of rows.
template <typename Scalar, typename Batch>
const Scalar* PositionsOf(const Batch& batch, Index sample, const Shape& shape, bool turns,
                          Vector<Scalar>& memory) {
  if (!turns) return batch.col(sample).data();
  memory.resize(shape.size());
  TurnToPositions(batch.col(sample).data(), shape, memory.data());
  return memory.data();
}

// Where to write them, and what to call when they are written.
template <typename Scalar>
Scalar* PositionsFor(Matrix<Scalar>& batch, Index sample, const Shape& shape, bool turns,
                     Vector<Scalar>& memory) {
  if (!turns) return batch.col(sample).data();
  memory.resize(shape.size());
  return memory.data();
}
template <typename Scalar>
void PutPositions(Matrix<Scalar>& batch, Index sample, const Shape& shape, bool turns,
                  const Vector<Scalar>& memory) {
  if (turns) TurnToChannels(memory.data(), shape, batch.col(sample).data());
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

// The inputs of a dense layer, a sample a row, as [channel][position].
template <typename Scalar>
RowView<const Scalar> RowsOfSamples(const Network::Stage& stage, const Inputs<Scalar>& input,
                                    Pass<Scalar>& pass) {
  if (!stage.turns_input) return {input.data(), input.outerStride()};
  pass.turned.resize(input.rows(), input.cols());
  for (Index sample = 0; sample < input.cols(); ++sample) {
    TurnToChannels(input.col(sample).data(), stage.input, pass.turned.col(sample).data());
  }
  return {pass.turned.data(), input.rows()};
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
    const RowView<const Scalar> rows = RowsOfSamples(stage, input, pass);
    const Scalar* weights = parameters.data() + stage.weights_begin;
    if (input.cols() < kManySamples) {
      MultiplyRows<Scalar>({weights, input.rows()}, rows, {output.data(), 1, units}, units, input.cols(),
                           input.rows(), Sum::kOverwrite);
    } else {
      pass.weights.resize(stage.weights);
      Transpose(weights, units, input.rows(), pass.weights.data());
      CombineRows<Scalar>({rows.data, rows.stride, 1}, {pass.weights.data(), units}, {output.data(), units},
                          input.cols(), input.rows(), units, Sum::kOverwrite);
    }
    output.colwise() += Biases(stage, parameters);
    Activate(layer.activation, output);
  }

  void operator()(const Convolution& layer) {
    const Index filters = layer.filters;
    const Index channels = stage.input.channels;
    const Index positions = stage.output.length;
    pass.weights.resize(stage.weights);
    TurnWeights(layer, stage.input.channels, parameters.data() + stage.weights_begin, pass.weights.data());
    OverSamples([&](const Scalar* in, Scalar* out) {
      CombineRows<Scalar>({in, channels * layer.stride, 1}, {pass.weights.data(), filters}, {out, filters},
                          positions, channels * layer.kernel, filters, Sum::kOverwrite);
      Eigen::Map<Matrix<Scalar>>(out, filters, positions).colwise() += Biases(stage, parameters);
    });
    Activate(layer.activation, output);
  }

  void operator()(const MaxPool& layer) {
    const Index channels = stage.input.channels;
    OverSamples([&](const Scalar* in, Scalar* out) {
      for (Index position = 0; position < stage.output.length; ++position) {
        const Scalar* from = in + position * layer.stride * channels;
        Scalar* to = out + position * channels;
        std::copy_n(from, channels, to);
        for (Index k = 1; k < layer.size; ++k) {
          for (Index c = 0; c < channels; ++c) to[c] = std::max(to[c], from[k * channels + c]);
        }
      }
    });
  }

  void operator()(const GlobalAveragePool&) {
    OverSamples([&](const Scalar* in, Scalar* out) {
      Eigen::Map<Vector<Scalar>>(out, stage.input.channels) =
          Eigen::Map<const Matrix<Scalar>>(in, stage.input.channels, stage.input.length).rowwise().mean();
    });
  }

 private:
  template <typename Task>
  void OverSamples(const Task& task) {
    for (Index sample = 0; sample < input.cols(); ++sample) {
      const Scalar* in = PositionsOf(input, sample, stage.input, stage.turns_input, pass.input_positions);
      task(in, PositionsFor(output, sample, stage.output, stage.turns_output, pass.output_positions));
      PutPositions(output, sample, stage.output, stage.turns_output, pass.output_positions);
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
    CombineRows<Scalar>({gradient, 1, units}, RowsOfSamples(stage, input, pass),
                        {parameter_gradient.data() + stage.weights_begin, inputs}, units, input.cols(),
                        inputs, Sum::kOverwrite);
    Biases(stage, parameter_gradient) = output_gradient.rowwise().sum();
    if (input_gradient == nullptr) return;
    Matrix<Scalar>& back = stage.turns_input ? pass.turned : *input_gradient;
    CombineRows<Scalar>({gradient, units, 1}, {parameters.data() + stage.weights_begin, inputs},
                        {back.data(), inputs}, input.cols(), units, inputs, Sum::kOverwrite);
    if (!stage.turns_input) return;
    for (Index sample = 0; sample < input.cols(); ++sample) {
      TurnToPositions(pass.turned.col(sample).data(), stage.input, input_gradient->col(sample).data());
    }
  }

  void operator()(const Convolution& layer) {
    MultiplyBySlope(layer.activation, output, output_gradient);
    const Index filters = layer.filters;
    const Index channels = stage.input.channels;
    const Index positions = stage.output.length;
    Biases(stage, parameter_gradient).setZero();
    pass.weight_gradient.resize(stage.weights);
    Sum sum = Sum::kOverwrite;
    for (Index sample = 0; sample < input.cols(); ++sample) {
      const Scalar* in = PositionsOf(input, sample, stage.input, stage.turns_input, pass.input_positions);
      const Scalar* gradient = GradientPositions(sample);
      CombineRows<Scalar>({in, 1, channels * layer.stride}, {gradient, filters},
                          {pass.weight_gradient.data(), filters}, channels * layer.kernel, positions, filters,
                          sum);
      Biases(stage, parameter_gradient) +=
          Eigen::Map<const Matrix<Scalar>>(gradient, filters, positions).rowwise().sum();
      sum = Sum::kAdd;
    }
    TurnWeightsBack(layer, stage.input.channels, pass.weight_gradient.data(),
                    parameter_gradient.data() + stage.weights_begin);
    if (input_gradient == nullptr) return;
    TurnInputWeights(layer);
    OverInputGradients([&](Index sample, Scalar* back) {
      const Scalar* gradient = GradientPositions(sample);
      for (Index kernel = 0; kernel < layer.kernel; ++kernel) {
        CombineRows<Scalar>(
            {gradient, filters, 1}, {pass.weights.data() + kernel * filters * channels, channels},
            {back + kernel * channels, channels * layer.stride}, positions, filters, channels, Sum::kAdd);
      }
    });
  }

  // To the first of the greatest: what is left of the gradient goes to the first position that has the
  // maximum.
  void operator()(const MaxPool& layer) {
    if (input_gradient == nullptr) return;
    const Index channels = stage.input.channels;
    Vector<Scalar> left(channels);
    Vector<Scalar> greatest;
    OverInputGradients([&](Index sample, Scalar* back) {
      const Scalar* in = PositionsOf(input, sample, stage.input, stage.turns_input, pass.weights);
      const Scalar* out = PositionsOf(output, sample, stage.output, stage.turns_output, greatest);
      const Scalar* gradient = GradientPositions(sample);
      for (Index position = 0; position < stage.output.length; ++position) {
        const Index begin = position * layer.stride * channels;
        std::copy_n(gradient + position * channels, channels, left.data());
        for (Index k = 0; k < layer.size; ++k) {
          PassOn(in + begin + k * channels, out + position * channels, channels, left.data(),
                 back + begin + k * channels);
        }
      }
    });
  }

  void operator()(const GlobalAveragePool&) {
    if (input_gradient == nullptr) return;
    const auto share = Scalar(1) / static_cast<Scalar>(stage.input.length);
    OverInputGradients([&](Index sample, Scalar* back) {
      Eigen::Map<Matrix<Scalar>>(back, stage.input.channels, stage.input.length).colwise() =
          (share * output_gradient.col(sample)).eval();
    });
  }

 private:
  static void PassOn(const Scalar* __restrict in, const Scalar* __restrict greatest, Index channels,
                     Scalar* __restrict left, Scalar* __restrict back) {
    for (Index c = 0; c < channels; ++c) {
      const Scalar share = in[c] == greatest[c] ? left[c] : Scalar(0);
      back[c] += share;
      left[c] -= share;
    }
  }

  const Scalar* GradientPositions(Index sample) {
    return PositionsOf(output_gradient, sample, stage.output, stage.turns_output, pass.output_positions);
  }

  // The gradient of each sample of the input, from zero on.
  template <typename Task>
  void OverInputGradients(const Task& task) {
    for (Index sample = 0; sample < input.cols(); ++sample) {
      Scalar* back =
          PositionsFor(*input_gradient, sample, stage.input, stage.turns_input, pass.input_positions);
      std::fill_n(back, stage.input.size(), Scalar(0));
      task(sample, back);
      PutPositions(*input_gradient, sample, stage.input, stage.turns_input, pass.input_positions);
    }
  }

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
