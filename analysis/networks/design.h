// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "analysis/networks/activation.h"

/// What a network is, without its numbers: plain values that can be written down, compared and exported.
namespace strainwave::analysis::networks {

/// A sample between layers: `channels` series of `length` values, one series after the other.
struct Shape {
  int channels{1};
  int length{1};

  int size() const { return channels * length; }
  bool operator==(const Shape&) const = default;
};

/// f(W x + b) of all values of a sample.
struct Dense {
  int units{};
  Activation activation{Activation::kLinear};
};

/// f(∑ over channels of the correlation with a kernel + b), at every position where the kernel fits
/// ('valid').
struct Convolution {
  int filters{};
  int kernel{};
  int stride{1};
  Activation activation{Activation::kLinear};
};

/// The greatest of each window, series by series.
struct MaxPool {
  int size{};
  int stride{1};
};

/// The mean of each series.
struct GlobalAveragePool {};

using Layer = std::variant<Dense, Convolution, MaxPool, GlobalAveragePool>;

struct Design {
  Shape input;
  std::vector<Layer> layers;
};

/// What a layer makes of a shape.
/// @throws std::invalid_argument if a size of the layer is not positive or does not fit into the shape, or a
///   sample has more than 2²⁶ values.
Shape OutputShape(const Layer& layer, const Shape& input);

/// The two models of docs/sources.md#shivam-2023, section V, by name, for any number of inputs and outputs
/// (204 and 4 there), linear at the output:
///   ann: dense 500, 500, 200, 100, sigmoid;
///   cnn: convolutions 128 of 6, 64 of 3, pool 3/2, 64 of 3, pool 3/2, 128 of 3, mean over the series, dense
///   128; ReLU.
/// @throws std::invalid_argument for another name, or numbers too small.
Design DesignOf(std::string_view name, int inputs, int outputs);

}  // namespace strainwave::analysis::networks
